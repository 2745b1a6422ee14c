#include "visualizer/color_map.h"

#include <algorithm>
#include <cmath>

namespace palpate::visualizer {
namespace {

// A smooth curve through tissue pink, red and purple, cut into equal steps of CIELAB.
constexpr int kStops = 17;
constexpr std::array<Rgb, kStops> kScale{{{243, 193, 175},
                                          {245, 178, 157},
                                          {246, 162, 140},
                                          {246, 146, 124},
                                          {244, 128, 109},
                                          {241, 109, 100},
                                          {235, 90, 98},
                                          {223, 76, 100},
                                          {213, 69, 107},
                                          {202, 62, 114},
                                          {188, 55, 119},
                                          {172, 51, 124},
                                          {155, 46, 127},
                                          {137, 40, 130},
                                          {116, 34, 130},
                                          {91, 25, 124},
                                          {62, 14, 112}}};

}  // namespace

Rgb map_color(double fraction) {
  const double clamped = fraction > 0 ? std::min(fraction, 1.0) : 0.0;  // NaN becomes 0 too
  const double place = clamped * (kStops - 1);
  const int lower = std::min(static_cast<int>(place), kStops - 2);
  const double weight = place - lower;
  Rgb color{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double a = kScale[lower][c], b = kScale[lower + 1][c];
    color[c] = static_cast<std::uint8_t>(std::lround(a + weight * (b - a)));
  }
  return color;
}

void append_colors(const std::vector<float>& values, double top, std::vector<std::uint8_t>& out) {
  constexpr int kTableSize = 256;
  std::array<Rgb, kTableSize> table{};
  for (int i = 0; i < kTableSize; ++i) table[i] = map_color(double(i) / (kTableSize - 1));
  out.reserve(out.size() + 3 * values.size());
  for (const float value : values) {
    const double scaled = value / top * (kTableSize - 1);
    const int i = scaled > 0 ? static_cast<int>(std::min(scaled, kTableSize - 1.0) + 0.5) : 0;
    out.insert(out.end(), table[i].begin(), table[i].end());
  }
}

double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= value * (1 - 1e-12)) return step * power;
  }
  return 10 * power;
}

}  // namespace palpate::visualizer
