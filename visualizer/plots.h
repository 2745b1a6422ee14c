// Live plots of the newest seconds: volume error, pressure, force.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "visualizer/history.h"
#include "visualizer/overlay.h"

namespace palpate::visualizer {

inline constexpr double kPlotSpan = 10;  ///< simulated seconds shown

struct Curve {
  const History* history = nullptr;
  Rgb color{};
  double factor = 1;      ///< from the history's unit to the axis'
  std::string name = {};  ///< written before its newest value, where there are several
};

/// The vertical axis: round limits and the distance of its grid lines.
struct Axis {
  double low = 0, high = 1, step = 0.5;
};
/// The smallest round axis of 2 … 6 steps that holds 0 and low … high. At least `least` tall.
Axis round_axis(double low, double high, double least);

/// One plot in its box: frame, grid, numbers, title with unit and newest values in the order of the
/// curves, curves.
void add_plot(const std::string& title, const std::vector<Curve>& curves, double time,
              const Box2& box, double least_height, Overlay& out);

/// The three plots of a view, from the top.
void add_plots(const SceneView& view, const std::array<Box2, 3>& boxes, Overlay& out);

}  // namespace palpate::visualizer
