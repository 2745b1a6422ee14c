// palpate calibrate: fits and checks spring stiffness against squeezed balls of finite elements.
#include <iostream>
#include <optional>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/core/whole_file.h"
#include "modules/runtime/program.h"
#include "studies/calibration/report.h"
#include "studies/report/progress.h"

namespace {

using namespace palpate;
using calibration::Case;

struct Options {
  std::filesystem::path reference = data_folder() / "reference";
  std::filesystem::path csv;
  std::string only;
  std::vector<int> nodes{642, 2562};
  std::optional<double> bending_ratio, inner_ratio;
  bool quick = false, outer_surface = false;
};

void add_options(runtime::Program& program, Options& options) {
  program.flag("--quick", options.quick, "Only compare, do not fit (under a minute)");
  program.add("--case", options.only, "Only this one: hollow or solid").one_of({"hollow", "solid"});
  program.add("--nodes", options.nodes, "Meshes: of 162, 642, 2562, 10242")
      .one_of({"162", "642", "2562", "10242"})
      .shows_default();
  program.add("--bending-ratio", options.bending_ratio, "Instead of the shipped one")
      .range(0.0, 10.0);
  program.add("--inner-ratio", options.inner_ratio, "Instead of the shipped one").range(0.0, 100.0);
  program.flag("--outer-surface", options.outer_surface,
               "Nodes on the outer surface instead of the middle of the wall");
  program.add_output("--csv", options.csv, "File for the comparison; an earlier one is replaced");
  program.add("--reference", options.reference, "Folder of the reference tables").shows_default();
}

std::vector<int> levels_of(const Options& options) {
  std::vector<int> levels;
  for (const int nodes : options.nodes) {
    int level = 0;
    while (calibration::node_count(level) < static_cast<std::size_t>(nodes)) ++level;
    levels.push_back(level);
  }
  return levels;
}

std::vector<Case> cases_of(const Options& options) {
  std::vector<Case> cases;
  if (options.only != "solid") cases.push_back(calibration::hollow_ball(options.reference));
  if (options.only != "hollow") cases.push_back(calibration::solid_ball(options.reference));
  for (Case& calibrated : cases) {
    auto& springs = calibrated.ball.organ.springs;
    springs.bending_ratio = options.bending_ratio.value_or(springs.bending_ratio);
    springs.inner_ratio = options.inner_ratio.value_or(springs.inner_ratio);
    if (options.outer_surface) calibrated.ball.surface_depth = 0;
  }
  return cases;
}

void fit(const Case& calibrated, const std::vector<int>& levels,
         const calibration::StopRequest& stop) {
  calibration::print_fit_header(calibrated, std::cout);
  std::vector<double> bending_ratios{calibrated.ball.organ.springs.bending_ratio};
  if (calibrated.fits_membrane) bending_ratios = {0, 0.1, 0.3, 1};
  for (const double bending_ratio : bending_ratios) {
    calibration::print_fit(calibrated, calibration::fit(calibrated, bending_ratio, levels, stop),
                           std::cout);
  }
}

int run(const Options& options) {
  const StopSignal signal;
  const auto stop = [&] { return signal.requested(); };
  const auto cases = cases_of(options);
  std::optional<WholeFile> csv;
  if (!options.csv.empty()) {
    csv.emplace(options.csv, calibration::kCsvHeader, "comparison of this kind");
  }
  for (const Case& calibrated : cases) {
    calibration::print_settings(calibrated, std::cout);
    std::cout.flush();
    if (!options.quick) fit(calibrated, levels_of(options), stop);
    std::vector<calibration::Comparison> comparisons;
    for (const int level : levels_of(options)) {
      comparisons.push_back(calibration::compare(calibrated, level, stop));
    }
    calibration::print_comparisons(calibrated, comparisons, std::cout);
    std::cout << std::endl;
    if (csv) calibration::write_csv(calibrated, comparisons, csv->stream());
  }
  if (csv) csv->finish();
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  runtime::Program program(
      "Squeeze balls between plates, fit inner springs and the membrane factor to\n"
      "finite-element solutions, and print what error is left (docs/calibration.md).",
      "palpate calibrate");
  Options options;
  add_options(program, options);
  program.footer(report::kExitCodesHelp);
  return program.run(argc, argv, [&] {
    try {
      return run(options);
    } catch (const report::Stopped&) {
      std::cerr << "stopped\n";
      return kExitStopped;
    }
  });
}
