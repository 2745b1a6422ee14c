// A perceptually uniform colour scale for soft tissue: pink at zero, deep purple at the top.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace palpate::visualizer {

using Rgb = std::array<std::uint8_t, 3>;

/// Colour of a fraction of the scale; outside 0 … 1 (and not a number) is clamped.
Rgb map_color(double fraction);

/// Appends the colours of values on the scale 0 … top (top > 0), three bytes each.
void append_colors(const std::vector<float>& values, double top, std::vector<std::uint8_t>& out);

/// A round number (1, 2 or 5 times a power of ten) not below `value`; value > 0.
double round_up(double value);

}  // namespace palpate::visualizer
