#include "bench/bullet/bullet_command.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <set>
#include <span>

#include "bench/bullet/bullet_ball.h"
#include "bench/bullet/palpate_ball.h"
#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "studies/report/measures.h"
#include "studies/report/progress.h"
#include "studies/report/table_file.h"

namespace palpate::bench {
namespace {

using MakeSqueezer = std::function<std::unique_ptr<Squeezer>()>;

struct Setting {
  std::string name;
  bool ours = false;
  MakeSqueezer make;
};

constexpr int kTimings = 5, kTimingsOfLarge = 2;
constexpr std::size_t kLarge = 5000;  // nodes

std::string name_of(const BulletSettings& settings) {
  std::string name = "iterations " + std::to_string(settings.position_iterations);
  if (settings.volume_stiffness > 0)
    name += report::text_of(", kVC V0 = %.0e Pa", settings.volume_stiffness);
  if (settings.gas_pressure > 0)
    name += report::text_of(", kPR/V0 = %.0f Pa", settings.gas_pressure);
  return name;
}

/// Iterations with the volume penalty off and on, its stiffness up to where it fails, gas pressures
/// about what the ball needs.
std::vector<BulletSettings> bullet_sweep(bool quick, bool large) {
  if (quick) return {{1, 0, 0}, {1, 1e4, 0}, {4, 1e5, 0}};
  const std::vector<int> iterations = large ? std::vector{1, 4} : std::vector{1, 2, 4, 8, 16};
  const auto stiffnesses =
      large ? std::vector{0.0, 3e4, 1e5} : std::vector{0.0, 1e4, 3e4, 1e5, 2e5, 4e5};
  const auto pressures = large ? std::vector{200.0} : std::vector{100.0, 200.0, 400.0};
  std::vector<BulletSettings> sweep;
  for (const int count : iterations) {
    for (const double stiffness : stiffnesses) sweep.push_back({count, stiffness, 0});
    for (const double pressure : pressures) sweep.push_back({count, 0, pressure});
  }
  return sweep;
}

std::vector<Setting> settings_for(const Ball& ball, const Squeeze& squeeze,
                                  const BulletOptions& options) {
  using scene::Integrator;
  std::vector<Setting> settings;
  for (const auto& of_bullet : bullet_sweep(options.quick, ball.surface.nodes.size() > kLarge)) {
    settings.push_back({name_of(of_bullet), false, [&ball, of_bullet] {
                          return std::make_unique<BulletBall>(ball, of_bullet);
                        }});
  }
  const auto add = [&](const std::string& name, const Method& method) {
    settings.push_back(
        {name, true, [&ball, method] { return std::make_unique<PalpateBall>(ball, method); }});
  };
  const int substeps = PalpateBall(ball, {}).substeps();
  const std::string steps = substeps == 1 ? "one step" : std::to_string(substeps) + " sub-steps";
  add("symplectic Euler, " + steps, {});
  add("symplectic Euler, " + steps + ", 1 correction", {.corrections = 1});
  add("backward Euler, one step", {.integrator = Integrator::kBackwardEuler});
  add("backward Euler, one step, 1 correction",
      {.integrator = Integrator::kBackwardEuler, .corrections = 1});
  const Method xpbd{.model = "xpbd_springs"};
  add("XPBD springs, " + std::to_string(PalpateBall(ball, xpbd).substeps()) + " sub-steps", xpbd);
  add("XPBD springs, 1 step that no scene takes: soft",
      {.model = "xpbd_springs", .one_step = true});
  settings.push_back({"whole pipeline as a scene runs it", true,
                      [&ball, squeeze] { return std::make_unique<PipelineBall>(ball, squeeze); }});
  return settings;
}

/// Of one size and side, those that are stable, took turns and have a time for `work`.
std::vector<const TableRow*> candidates(const std::vector<TableRow>& rows, std::size_t nodes,
                                        bool ours, Work work) {
  std::size_t most = 0;
  for (const TableRow& row : rows) {
    if (row.nodes == nodes) most = std::max(most, row.turns.size());
  }
  std::vector<const TableRow*> found;
  for (const TableRow& row : rows) {
    if (row.nodes != nodes || row.ours != ours || !row.outcome.stable()) continue;
    if (row.turns.size() < most || std::isnan(time_of(row.outcome.cost, work))) continue;
    found.push_back(&row);
  }
  return found;
}

const TableRow* cheapest(const std::vector<const TableRow*>& rows, Work work) {
  const auto found = std::min_element(rows.begin(), rows.end(), [&](auto* a, auto* b) {
    return time_of(a->outcome.cost, work) < time_of(b->outcome.cost, work);
  });
  return found == rows.end() ? nullptr : *found;
}

const TableRow* most_accurate(const std::vector<const TableRow*>& rows) {
  const auto found = std::min_element(
      rows.begin(), rows.end(), [](auto* a, auto* b) { return a->outcome.held < b->outcome.held; });
  return found == rows.end() ? nullptr : *found;
}

Cost median_of(const std::vector<Cost>& turns) {
  std::vector<double> solver, whole;
  for (const Cost& turn : turns) {
    solver.push_back(turn.solver);
    whole.push_back(turn.whole);
  }
  return {report::median(solver), report::median(whole)};
}

/// Runs ours and the best of Bullet's again, in turn.
void take_turns(const std::vector<Setting>& settings, const Squeeze& squeeze, int timings,
                report::Progress& progress, const std::function<void()>& keep_going,
                std::span<TableRow> rows) {
  const std::vector<TableRow> first(rows.begin(), rows.end());
  const auto bullets = candidates(first, rows[0].nodes, false, Work::kWhole);
  const std::set<const TableRow*> chosen{cheapest(bullets, Work::kSolver),
                                         cheapest(bullets, Work::kWhole), most_accurate(bullets)};
  for (int timing = 1; timing <= timings; ++timing) {
    progress.begin("timing in turn: " + std::to_string(timing));
    for (std::size_t i = 0; i < settings.size(); ++i) {
      if (!rows[i].ours && chosen.count(&first[i]) == 0) continue;
      if (timing == 1) rows[i].turns.clear();
      rows[i].turns.push_back(run(*settings[i].make(), squeeze, keep_going).cost);
      rows[i].outcome.cost = median_of(rows[i].turns);
    }
  }
}

void compare_size(const BulletOptions& options, std::size_t nodes, report::Progress& progress,
                  const std::function<void()>& keep_going, std::vector<TableRow>& rows) {
  const bool large = nodes > kLarge;
  const Squeeze squeeze = large ? Squeeze{0.5, 250, 250} : Squeeze{};
  const Ball ball = make_bench_ball(nodes);
  const auto settings = settings_for(ball, squeeze, options);
  const std::size_t first = rows.size();
  for (const Setting& setting : settings) {
    progress.begin(std::to_string(nodes) + " nodes, " + (setting.ours ? "ours" : "Bullet") + ": " +
                   setting.name);
    const Outcome outcome = run(*setting.make(), squeeze, keep_going);
    rows.push_back(
        {ball.surface.nodes.size(), setting.ours, setting.name, outcome, {outcome.cost}});
  }
  if (options.quick) return;
  take_turns(settings, squeeze, large ? kTimingsOfLarge : kTimings, progress, keep_going,
             std::span(rows).subspan(first));
}

/// Empty where there is none.
std::string cell_of(const char* format, double value) {
  return std::isnan(value) ? "" : report::text_of(format, value);
}

std::vector<std::string> cells(const TableRow& row) {
  const Outcome& o = row.outcome;
  return {std::to_string(row.nodes),
          row.ours ? "ours" : "Bullet",
          row.setting,
          cell_of("%.1f", o.cost.solver),
          cell_of("%.1f", o.cost.whole),
          report::text_of("%.2e", o.peak),
          report::text_of("%.2e", o.held),
          cell_of("%.0f", o.pressure),
          std::to_string(o.contacts),
          report::text_of("%.3f", 1e3 * o.beyond),
          o.verdict()};
}

const std::vector<std::string>& columns() {
  static const std::vector<std::string> names{"nodes",
                                              "solver",
                                              "setting",
                                              "solver_us_per_step",
                                              "whole_us_per_step",
                                              "volume_error_peak",
                                              "volume_error_held",
                                              "pressure_Pa",
                                              "contacts",
                                              "beyond_plate_mm",
                                              "verdict"};
  return names;
}

/// Bullet's time over ours: median, worst and best of the turns.
std::string times_fewer(const TableRow& bullet, const TableRow& ours, Work work) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < std::min(bullet.turns.size(), ours.turns.size()); ++k) {
    ratios.push_back(time_of(bullet.turns[k], work) / time_of(ours.turns[k], work));
  }
  if (ratios.size() == 1) return report::text_of("%.2f", ratios[0]);
  const auto [worst, best] = std::minmax_element(ratios.begin(), ratios.end());
  return report::text_of("%.2f", report::median(ratios)) + " (" + report::text_of("%.2f", *worst) +
         " to " + report::text_of("%.2f", *best) + ")";
}

void print_ratios_of(const std::vector<TableRow>& rows, std::size_t nodes, Work work,
                     std::ostream& out) {
  out << '\n'
      << nodes << " nodes, "
      << (work == Work::kSolver
              ? "solver alone: contacts given on both sides"
              : "whole step: contacts searched on both sides; ours holds devices, local contact "
                "models and haptic forces, too")
      << '\n';
  const auto bullets = candidates(rows, nodes, false, work);
  const TableRow *cheap = cheapest(bullets, work), *accurate = most_accurate(bullets);
  if (cheap == nullptr) {
    out << "  no setting of Bullet was stable\n";
    return;
  }
  out << "  Bullet cheapest: " << cheap->setting << "; most accurate: " << accurate->setting
      << '\n';
  for (const TableRow* row : candidates(rows, nodes, true, work)) {
    out << "  " << row->setting << ": " << times_fewer(*cheap, *row, work)
        << " x fewer us per step than the cheapest, " << times_fewer(*accurate, *row, work)
        << " x than the most accurate; held volume error "
        << report::text_of("%.1e", accurate->outcome.held / row->outcome.held)
        << " x smaller than the latter's; contents push with "
        << report::text_of("%.0f Pa", row->outcome.pressure) << ", " << row->outcome.contacts
        << " contacts\n";
  }
}

}  // namespace

std::vector<TableRow> compare(const BulletOptions& options, std::ostream& log,
                              const std::function<void()>& keep_going) {
  report::Progress progress(log, [] { return false; });
  std::vector<TableRow> rows;
  for (const std::size_t nodes : options.nodes) {
    compare_size(options, nodes, progress, keep_going, rows);
  }
  return rows;
}

double time_of(const Cost& cost, Work work) {
  return work == Work::kSolver ? cost.solver : cost.whole;
}

void print_table(const std::vector<TableRow>& rows, std::ostream& out) {
  const auto line = [&](const std::vector<std::string>& c) {
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(), "%6s  %-7s %-48s %19s %18s %18s %18s %12s %9s  %s\n",
                  c[0].c_str(), c[1].c_str(), c[2].c_str(), c[3].c_str(), c[4].c_str(),
                  c[5].c_str(), c[6].c_str(), c[7].c_str(), c[8].c_str(), c[9].c_str());
    out << text.data();
  };
  line(columns());
  for (const TableRow& row : rows) line(cells(row));
}

void print_ratios(const std::vector<TableRow>& rows, std::ostream& out) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && rows[i].nodes == rows[i - 1].nodes) continue;
    print_ratios_of(rows, rows[i].nodes, Work::kSolver, out);
    print_ratios_of(rows, rows[i].nodes, Work::kWhole, out);
  }
}

void write_table(const std::vector<TableRow>& rows, const std::filesystem::path& file) {
  report::TableFile table(file, columns());
  for (const TableRow& row : rows) table.write_row(cells(row));
  table.finish();
}

int run_bullet(const BulletOptions& options, std::ostream& out, std::ostream& log) {
  if (!options.out.empty()) report::make_out_folder(options.out);
  const StopSignal stop;
  try {
    const auto rows = compare(options, log, [&] {
      if (stop.requested()) throw report::Stopped{};
    });
    out << "ball squeezed to 50 %, h = 2 ms, " << report::machine_name()
        << ", one thread, processor time; on a shared machine only ratios of one run mean much\n";
    print_table(rows, out);
    print_ratios(rows, out);
    if (!options.out.empty()) write_table(rows, options.out / "bullet.csv");
    return kExitDone;
  } catch (const report::Stopped&) {
    log << "stopped" << std::endl;
    return kExitStopped;
  }
}

}  // namespace palpate::bench
