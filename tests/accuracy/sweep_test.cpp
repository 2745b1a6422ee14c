#include "bench/accuracy/sweep.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/accuracy/folders.h"

namespace palpate::accuracy {
namespace {

const KeepGoing kOn = [] {};

TEST_CASE("sweep: what was measured is not measured again and comes back the same") {
  // Oracle: a second sweep that is stopped at the first measurement finishes all the same.
  const testing::WorkFolder folder;
  const PointStore store(folder.path / "points");
  const std::vector<Case> of{find_case("ball")};
  const std::vector<scene::Model> models{scene::Model::kMassSpring};
  const auto begin = [](const std::string&, int, int) {};
  const auto first = sweep(of, Extent::kQuick, models, testing::source(), store, begin, kOn);
  REQUIRE(first.size() == 1);
  struct Stop {};
  const auto again =
      sweep(of, Extent::kQuick, models, testing::source(), store, begin, [] { throw Stop{}; });
  REQUIRE(again.size() == 1);
  const auto &a = first[0].measurement, &b = again[0].measurement;
  CHECK(a.surface_nodes == b.surface_nodes);
  REQUIRE(a.samples.size() == b.samples.size());
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    CHECK(b.samples[i].force == Approx(a.samples[i].force).epsilon(1e-9));
    CHECK(std::isnan(b.samples[i].field_error));
  }
}

TEST_CASE("sweep: quick is less than usual, usual less than full; truths are measured first") {
  // Oracle: the extents' meaning.
  for (const Case& of : cases()) {
    const auto quick = settings_of(of, Extent::kQuick), usual = settings_of(of, Extent::kUsual);
    CHECK(quick.size() < usual.size());
    CHECK(usual.size() < settings_of(of, Extent::kFull).size());
    if (!of.truth_is_finest) continue;
    const auto truth = truth_setting(of, Extent::kUsual).key();
    CHECK(usual.front().key() == truth);
    CHECK(std::count_if(usual.begin(), usual.end(),
                        [&](const Setting& setting) { return setting.key() == truth; }) == 1);
  }
}

}  // namespace
}  // namespace palpate::accuracy
