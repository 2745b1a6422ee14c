#include "studies/chart/chart_command.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "modules/core/error.h"
#include "tests/studies/chart/folders.h"

namespace palpate::chart {
namespace {

TEST_CASE("chart command: tables and charts of one case appear") {
  // Oracle: the promised files; the printed table names the model.
  const testing::WorkFolder folder;
  ChartOptions options;
  options.out = folder.path;
  options.only_cases = {"ball"};
  options.only_models = {"mass_spring", "implicit_volume"};
  options.extent = Extent::kQuick;
  options.peers = false;
  std::ostringstream out, log;
  CHECK(run_chart(options, out, log) == kExitDone);
  CHECK_THAT(out.str(), Catch::Contains("implicit_volume"));
  for (const char* name :
       {"points.csv", "samples.csv", "accuracy_cost.png", "accuracy_mesh.png",
        "accuracy_cost_mesh.png", "accuracy_volume.png", "accuracy_curves.png", "results.md"}) {
    INFO(name);
    CHECK(std::filesystem::exists(folder.path / name));
  }
}

TEST_CASE("chart command: unknown cases and models are refused with what there is") {
  // Oracle: the messages.
  const testing::WorkFolder folder;
  ChartOptions options;
  options.out = folder.path;
  std::ostringstream out, log;
  options.only_cases = {"cone"};
  CHECK_THROWS_WITH(run_chart(options, out, log), Catch::Contains("case 'cone': must be one of"));
  options.only_cases = {};
  options.only_models = {"jelly"};
  CHECK_THROWS_WITH(run_chart(options, out, log),
                    Catch::Contains("model 'jelly': must be one of mass_spring"));
  options.extent = Extent::kQuick;
  options.only_cases = {"squeeze"};  // of solids
  options.only_models = {"implicit_volume"};
  CHECK_THROWS_WITH(run_chart(options, out, log), Catch::Contains("none of these cases runs any"));
}

}  // namespace
}  // namespace palpate::chart
