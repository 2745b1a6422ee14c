#include "studies/certify/tables.h"

#include "studies/report/measures.h"
#include "studies/report/table_file.h"

namespace palpate::certify {

void write_law(const std::vector<LawStiffness>& law, const std::filesystem::path& folder) {
  report::TableFile table(folder / "law.csv", {"depth_m", "law_n_per_m", "organ_n_per_m"});
  for (const auto& point : law) table.write_row({point.depth, point.law, point.organ});
  table.finish();
}

void write_still_force(const std::vector<StillForce>& forces, const std::filesystem::path& folder) {
  report::TableFile table(folder / "force.csv", {"depth_m", "felt_n", "organ_n"});
  for (const auto& point : forces) table.write_row({point.depth, point.felt, point.organ});
  table.finish();
}

void write_ticks(const std::vector<Tick>& ticks, const std::filesystem::path& file) {
  report::TableFile table(
      file, {"time_s", "depth_m", "force_n", "motor_n", "step_n", "work_j", "limits"});
  for (const Tick& tick : ticks) {
    table.write_row({tick.time, tick.depth, tick.force, tick.motor, tick.step, tick.work,
                     static_cast<double>(tick.limits)});
  }
  table.finish();
}

void write_timing(const Timing& timing, const std::filesystem::path& folder) {
  report::TableFile table(folder / "timing.csv", {"share", "period_s", "latency_s"});
  constexpr int kPoints = 2000;
  for (int i = 1; i <= kPoints; ++i) {
    const double share = double(i) / kPoints;
    table.write_row({share, report::quantile(timing.periods, share),
                     report::quantile(timing.latencies, share)});
  }
  table.finish();
}

void write_slide(const std::vector<SlideTick>& ticks, const std::filesystem::path& folder) {
  report::TableFile table(folder / "slide.csv",
                          {"time_s", "x_m", "y_m", "z_m", "force_n", "step_n", "over"});
  for (const SlideTick& t : ticks) {
    table.write_row(
        {t.time, t.position.x(), t.position.y(), t.position.z(), t.force, t.step, t.over()});
  }
  table.finish();
}

}  // namespace palpate::certify
