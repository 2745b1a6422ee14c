#include "deformation/guard_text.h"

#include <catch2/catch.hpp>
#include <set>
#include <string>

#include "deformation/guard/divergence_detector.h"

namespace palpate::deformation {
namespace {

TEST_CASE("guard text: every code has words of its own, no guard has none") {
  // Oracle: counting.
  GuardText words;
  std::set<std::string> texts;
  for (std::size_t k = 0; k < kGuardCodes; ++k) {
    texts.emplace(words.of({static_cast<GuardCode>(k), 1}));
  }
  CHECK(texts.size() == kGuardCodes);
  CHECK(texts.count("") == 0);
  CHECK(std::string(words.of({})).empty());
}

TEST_CASE("guard text: says how often a guard acted, and the limit it acts at") {
  // Oracle: the guards' constants.
  GuardText words;
  const std::string once = words.of({GuardCode::kTooFast, 1});
  CHECK_THAT(once, Catch::Contains(std::to_string(int(kMaxNodeSpeed)) + " m/s"));
  CHECK(words.of({GuardCode::kTooFast, 3}) == once + " (3 times)");
  CHECK_THAT(words.of({GuardCode::kTooLarge, 1}),
             Catch::Contains(std::to_string(int(kMaxGrowth)) + " times"));
}

}  // namespace
}  // namespace palpate::deformation
