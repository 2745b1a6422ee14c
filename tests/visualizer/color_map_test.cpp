#include "visualizer/color_map.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace palpate::visualizer;

namespace {

/// CIE 1976 L*a*b* of an sRGB colour, white D65.
std::array<double, 3> lab(const Rgb& rgb) {
  const auto linear = [](double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  const double r = linear(rgb[0] / 255.0), g = linear(rgb[1] / 255.0), b = linear(rgb[2] / 255.0);
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  const double x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
  const double y = f(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
  const double z = f((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

}  // namespace

TEST_CASE("colour map: equal steps of the value look equally different", "[visualizer]") {
  // Oracle: analytic, CIE 1976 colour difference. Tolerance 10 %: rounding to 8 bits moves each
  // component by up to half a level, about 0.4 of a difference of 8.7 between stops.
  double least = 1e9, largest = 0;
  for (int i = 0; i < 16; ++i) {
    const auto a = lab(map_color(i / 16.0)), b = lab(map_color((i + 1) / 16.0));
    const double step = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    least = std::min(least, step);
    largest = std::max(largest, step);
    CHECK(b[0] < a[0]);  // darker with every step: readable in grey and by the colour-blind
  }
  CHECK(largest / least < 1.1);
}

TEST_CASE("colour map: values outside the scale and NaN are clamped", "[visualizer]") {
  // Oracle: the stated rule.
  CHECK(map_color(-3) == map_color(0));
  CHECK(map_color(7) == map_color(1));
  CHECK(map_color(std::numeric_limits<double>::quiet_NaN()) == map_color(0));
}

TEST_CASE("colour map: arrays get the colours of single values", "[visualizer]") {
  // Oracle: map_color() itself; the array version uses 256 levels, so it may differ by the
  // rounding of one level: 2 of 255.
  const std::vector<float> values{-1, 0, 0.1f, 0.25f, 0.4f, 0.5f, 9, std::nanf("")};
  std::vector<std::uint8_t> colors;
  append_colors(values, 0.5, colors);
  REQUIRE(colors.size() == 3 * values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Rgb expected = map_color(values[i] / 0.5);
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(std::abs(int(colors[3 * i + c]) - int(expected[c])) <= 2);
    }
  }
}

TEST_CASE("round_up: the next 1, 2 or 5 times a power of ten", "[visualizer]") {
  // Oracle: worked by hand.
  CHECK(round_up(1) == Approx(1));
  CHECK(round_up(1.01) == Approx(2));
  CHECK(round_up(0.021) == Approx(0.05));
  CHECK(round_up(51) == Approx(100));
  CHECK(round_up(3e-7) == Approx(5e-7));
}
