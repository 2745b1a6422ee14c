#include "studies/certify/release.h"

#include <catch2/catch.hpp>

using namespace palpate;
using namespace palpate::certify;

namespace {

int failed(const std::vector<Release>& releases) {
  int count = 0;
  for (const Line& line : release_lines(releases, scene::Scene())) {
    INFO(text_of(line));
    count += line.verdict == Verdict::kFail;
  }
  return count;
}

}  // namespace

TEST_CASE("certify release: late, with a step, never or for good: each fails its line") {
  // Oracle: definition: 110 ms and 0.2 N with the limits of a scene that says nothing.
  const Release good{"driver killed", 0.1, 0.19, true, true};
  CHECK(failed({good, {"deformation killed", 0.099, 0.2, true, true}}) == 0);
  CHECK(failed({good, {"driver killed", 0.111, 0.1, true, true}}) == 1);
  CHECK(failed({good, {"driver killed", 0.1, 0.21, true, true}}) == 1);
  CHECK(failed({good, {"driver killed", 0.1, 0.1, false, true}}) == 1);
  CHECK(failed({good, {"haptics killed", 0.109, 0.1, true, true}}) == 0);
  CHECK(failed({good, {"haptics killed", 0.111, 0.1, true, true}}) == 1);
  CHECK(failed({good, {"collision killed", 0.1, 0.1, true, false}}) == 1);
  CHECK(failed({good, {"paused", 0.111, 0.21, true, true}}) == 2);
  CHECK(failed({good, {"at fault", 0.111, 0.1, true, true}}) == 1);
  CHECK(failed({good, {"reset", 0.1, 0.21, true, false}}) == 2);
}
