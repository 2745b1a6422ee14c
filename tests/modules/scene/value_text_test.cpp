#include "modules/scene/value_text.h"

#include <yaml-cpp/yaml.h>

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <random>

using namespace palpate;
using namespace palpate::scene;

TEST_CASE("value text: numbers a person typed come back as they were typed") {
  // Oracle: the texts themselves.
  CHECK(number_text(0.006) == "0.006");
  CHECK(number_text(1058) == "1058");
  CHECK(number_text(0.1) == "0.1");
  CHECK(number_text(-3) == "-3");
  CHECK(number_text(1e7) == "1e+07");
}

TEST_CASE("value text: any finite double survives as text, bit by bit") {
  // Oracle: the C library's strtod, over seeded random bit patterns.
  std::mt19937_64 random(1);
  int tried = 0;
  while (tried < 10'000) {
    const double number = std::bit_cast<double>(random());
    if (!std::isfinite(number)) continue;
    ++tried;
    const double back = std::strtod(number_text(number).c_str(), nullptr);
    if (std::bit_cast<std::uint64_t>(back) != std::bit_cast<std::uint64_t>(number)) {
      FAIL(number_text(number));
    }
  }
  CHECK(tried == 10'000);
}

TEST_CASE("value text: lists keep the order of the key's name") {
  // Oracle: by hand; Eigen's constructor takes w first, the key says xyzw.
  CHECK(list_text(Vec3(1, -2, 0.5)) == "[1, -2, 0.5]");
  CHECK(list_text(Quat(4, 1, 2, 3)) == "[1, 2, 3, 4]");
}

TEST_CASE("value text: quoted texts survive YAML") {
  // Oracle: independent tool, the parser of yaml-cpp.
  for (const std::string text : {"plain", "", "with space", "say \"hi\"", "back\\slash", "a: b # c",
                                 "tab\tline\nend\x7f", "Magen – größer", "- [x]", "true", "0x10"}) {
    INFO(text);
    CHECK(YAML::Load(quoted_text(text)).as<std::string>() == text);
  }
}
