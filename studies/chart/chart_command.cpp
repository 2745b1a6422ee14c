#include "studies/chart/chart_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ostream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/scene/schema.h"
#include "studies/chart/accuracy_tables.h"
#include "studies/chart/truth_cube.h"
#include "studies/report/measures.h"
#include "studies/report/pace.h"
#include "studies/report/plot_script.h"
#include "studies/report/progress.h"

namespace palpate::chart {
namespace {

std::vector<Case> wanted_cases(const ChartOptions& options, std::ostream& log) {
  std::vector<Case> wanted;
  for (const auto& name : options.only_cases) wanted.push_back(find_case(name));
  if (wanted.empty()) wanted = cases();
  const auto without_data = [&](const Case& of) {
    if (std::string(of.name) != "truthcube" || truth_cube_folder()) return false;
    log << "truthcube: SKIPPED: PALPATE_DATA is not there\n";
    return true;
  };
  wanted.erase(std::remove_if(wanted.begin(), wanted.end(), without_data), wanted.end());
  for (Case& each : wanted) each.truth_count = std::min(each.truth_count, options.places);
  return wanted;
}

std::vector<std::string> wanted_models(const ChartOptions& options) {
  if (options.only_models.empty()) return model_hierarchy();
  std::vector<std::string> wanted;
  for (const auto& name : options.only_models) {
    const auto all = model_hierarchy();
    const auto found = std::ranges::find(all, name);
    if (found == all.end()) {
      throw InputError(fmt::format("model '{}': must be one of {}", name, fmt::join(all, ", ")));
    }
    wanted.push_back(*found);
  }
  return wanted;
}

std::string line_of(const Outlook& outlook) {
  return fmt::format("{} of {}: {}", outlook.done + 1, outlook.total, outlook.job) +
         report::text_of_time_left(outlook.seconds_left);
}

/// How well the beads of the Truth Cube themselves are known.
void print_noise(const std::vector<Case>& of, std::ostream& out) {
  for (const Case& each : of) {
    if (std::string(each.name) != "truthcube") continue;
    const TruthCube cube = read_truth_cube(*truth_cube_folder());
    for (const auto& [compression, beads] : cube.states) {
      out << fmt::format("Truth Cube at {:g} %: tracking noise of the beads {:.2f} mm\n",
                         100 * compression, 1e3 * tracking_noise(cube, compression));
    }
  }
}

/// Bullet squeezes the ball in a program of its own, ours beside it.
void measure_peers(const ChartOptions& options, const KeepGoing& keep_going, std::ostream& log) {
  if (!std::filesystem::exists(options.bullet_program)) {
    log << "Bullet: SKIPPED: palpate-bench-bullet was not built (libbullet-dev)\n";
    return;
  }
  const auto table = options.out / "bullet.csv";
  if (!options.again && std::filesystem::exists(table)) return;
  std::vector<std::string> words{options.bullet_program.string(), "--out", options.out.string()};
  if (options.extent != Extent::kFull) words.insert(words.end(), {"--nodes", "642"});
  if (options.extent == Extent::kQuick) words.emplace_back("--quick");
  if (report::run_program(words, keep_going) != 0) {
    throw std::runtime_error(options.bullet_program.string() + " failed");
  }
}

}  // namespace

std::vector<std::string> case_names() {
  std::vector<std::string> names;
  for (const Case& each : cases()) names.emplace_back(each.name);
  return names;
}

int run_chart(const ChartOptions& options, std::ostream& out, std::ostream& log) {
  report::make_out_folder(options.out);
  const auto of = wanted_cases(options, log);
  const auto models = wanted_models(options);
  if (options.again) std::filesystem::remove_all(options.out / "points");
  const PointStore store(options.out / "points", log);
  const StopSignal stop;
  report::Claims claims(options.out / "points" / "claims", options.shard);
  const KeepGoing keep_going = [&] {
    if (stop.requested()) throw report::Stopped{};
    claims.keep();
  };
  try {
    const auto result = sweep(
        of, options.extent, models, store, claims,
        [&](const Outlook& outlook) { log << line_of(outlook) << std::endl; }, keep_going);
    if (options.shard) {
      out << report::text_of(result.share, *options.shard);
      return kExitDone;
    }
    if (result.points.empty()) {
      throw InputError("none of these cases runs any of these models: palpate list models");
    }
    write_tables(result, options.out);
    print(result, out);
    print_noise(of, out);
    if (options.peers) measure_peers(options, keep_going, log);
    out << "on " << report::machine_name() << '\n';
    report::draw_figures(data_file("plots/plot_accuracy.py"), options.out, {}, keep_going);
    out << "in " << options.out.string()
        << ": the charts, models.csv, points.csv, samples.csv, profiles.csv, "
           "reference_solutions.csv"
        << (std::filesystem::exists(options.out / "bullet.csv") ? ", bullet.csv" : "")
        << "; points/ is what a next run starts from\n";
    return kExitDone;
  } catch (const report::Stopped&) {
    log << "stopped; finished points stay in " << (options.out / "points").string()
        << " and are not measured again" << std::endl;
    return kExitStopped;
  }
}

}  // namespace palpate::chart
