#include "bench/bullet/bullet_command.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "bench/bullet/bullet_ball.h"
#include "bench/bullet/palpate_ball.h"
#include "modules/core/error.h"
#include "modules/runtime/stop_signal.h"
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
    name += text_of(", kVC V0 = %.0e Pa", settings.volume_stiffness);
  if (settings.gas_pressure > 0) name += text_of(", kPR/V0 = %.0f Pa", settings.gas_pressure);
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
  add("XPBD springs, one step, 1 pass", {.model = scene::Model::kXpbdSprings, .one_step = true});
  settings.push_back({"whole pipeline: devices, collision, haptics", true,
                      [&ball, squeeze] { return std::make_unique<PipelineBall>(ball, squeeze); }});
  return settings;
}

bool cheaper(const TableRow& a, const TableRow& b) {
  return a.outcome.us_per_step < b.outcome.us_per_step;
}
bool more_accurate(const TableRow& a, const TableRow& b) { return a.outcome.held < b.outcome.held; }

using Order = bool (*)(const TableRow&, const TableRow&);

/// The first by `order` of the stable rows of one size and side, of those run most often: these
/// took turns. nullptr if there is none.
const TableRow* best(const std::vector<TableRow>& rows, std::size_t nodes, bool ours, Order order) {
  const TableRow* found = nullptr;
  for (const TableRow& row : rows) {
    if (row.nodes != nodes || row.ours != ours || !row.outcome.stable()) continue;
    if (found == nullptr || row.runs > found->runs ||
        (row.runs == found->runs && order(row, *found))) {
      found = &row;
    }
  }
  return found;
}

void compare_size(const BulletOptions& options, std::size_t nodes, Progress& progress,
                  const std::function<void()>& keep_going, std::vector<TableRow>& rows) {
  const bool large = nodes > kLarge;
  const Squeeze squeeze = large ? Squeeze{0.5, 250, 250} : Squeeze{};
  const Ball ball = make_bench_ball(nodes);
  const auto settings = settings_for(ball, squeeze, options);
  const std::size_t first = rows.size();
  for (const Setting& setting : settings) {
    progress.begin(std::to_string(nodes) + " nodes, " + (setting.ours ? "ours" : "Bullet") + ": " +
                   setting.name);
    rows.push_back({ball.surface.nodes.size(), setting.ours, setting.name,
                    run(*setting.make(), squeeze, keep_going)});
  }
  const std::size_t count = ball.surface.nodes.size();
  const TableRow* cheapest = best(rows, count, false, cheaper);
  const TableRow* most_accurate = best(rows, count, false, more_accurate);
  std::vector<std::vector<double>> times(settings.size());
  const int timings = options.quick ? 1 : large ? kTimingsOfLarge : kTimings;
  for (int timing = 1; timing < timings; ++timing) {
    progress.begin("timing again, in turn: " + std::to_string(timing));
    for (std::size_t i = 0; i < settings.size(); ++i) {
      const TableRow& row = rows[first + i];
      if (!row.ours && &row != cheapest && &row != most_accurate) continue;
      times[i].push_back(run(*settings[i].make(), squeeze, keep_going).us_per_step);
    }
  }
  for (std::size_t i = 0; i < settings.size(); ++i) {
    times[i].push_back(rows[first + i].outcome.us_per_step);
    rows[first + i].outcome.us_per_step = median(times[i]);
    rows[first + i].runs = static_cast<int>(times[i].size());
  }
}

std::vector<std::string> cells(const TableRow& row) {
  const Outcome& o = row.outcome;
  return {std::to_string(row.nodes),
          row.ours ? "ours" : "Bullet",
          row.setting,
          text_of("%.1f", o.us_per_step),
          text_of("%.2e", o.peak),
          text_of("%.2e", o.held),
          std::isnan(o.pressure) ? "" : text_of("%.0f", o.pressure),
          o.verdict()};
}

const std::vector<std::string>& columns() {
  static const std::vector<std::string> names{
      "nodes",       "solver", "setting", "us_per_step", "volume_error_peak", "volume_error_held",
      "pressure_Pa", "verdict"};
  return names;
}

}  // namespace

std::vector<TableRow> compare(const BulletOptions& options, std::ostream& log,
                              const std::function<void()>& keep_going) {
  Progress progress(log, [] { return false; });
  std::vector<TableRow> rows;
  for (const std::size_t nodes : options.nodes) {
    compare_size(options, nodes, progress, keep_going, rows);
  }
  return rows;
}

void print_table(const std::vector<TableRow>& rows, std::ostream& out) {
  const auto line = [&](const std::vector<std::string>& c) {
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(), "%6s  %-7s %-46s %12s %18s %18s %12s  %s\n",
                  c[0].c_str(), c[1].c_str(), c[2].c_str(), c[3].c_str(), c[4].c_str(),
                  c[5].c_str(), c[6].c_str(), c[7].c_str());
    out << text.data();
  };
  line(columns());
  for (const TableRow& row : rows) line(cells(row));
}

void print_ratios(const std::vector<TableRow>& rows, std::ostream& out) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && rows[i].nodes == rows[i - 1].nodes) continue;
    const TableRow* cheapest = best(rows, rows[i].nodes, false, cheaper);
    const TableRow* accurate = best(rows, rows[i].nodes, false, more_accurate);
    out << '\n' << rows[i].nodes << " nodes:";
    if (cheapest == nullptr) {
      out << " no setting of Bullet was stable\n";
      continue;
    }
    out << " Bullet cheapest: " << cheapest->setting << "; most accurate: " << accurate->setting
        << '\n';
    for (const TableRow& row : rows) {
      if (row.nodes != rows[i].nodes || !row.ours || !row.outcome.stable()) continue;
      const double time = cheapest->outcome.us_per_step / row.outcome.us_per_step;
      const double error = accurate->outcome.held / row.outcome.held;
      out << "  " << row.setting << ": " << text_of("%.2f", time)
          << " x fewer us per step (goal 8), held volume error " << text_of("%.1e", error)
          << " x smaller (goal 1e3)\n";
    }
  }
}

void write_table(const std::vector<TableRow>& rows, const std::filesystem::path& file) {
  TableFile table(file, columns());
  for (const TableRow& row : rows) table.write_row(cells(row));
  table.finish();
}

int run_bullet(const BulletOptions& options, std::ostream& out, std::ostream& log) {
  if (!options.out.empty()) make_out_folder(options.out);
  const runtime::StopSignal stop;
  try {
    const auto rows = compare(options, log, [&] {
      if (stop.requested()) throw Stopped{};
    });
    out << "ball squeezed to 50 %, h = 2 ms, " << machine_name()
        << ", one thread, processor time\n";
    print_table(rows, out);
    print_ratios(rows, out);
    if (!options.out.empty()) write_table(rows, options.out / "bullet.csv");
    return kExitDone;
  } catch (const Stopped&) {
    log << "stopped" << std::endl;
    return kExitStopped;
  }
}

}  // namespace palpate::bench
