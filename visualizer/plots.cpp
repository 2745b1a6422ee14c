#include "visualizer/plots.h"

#include <algorithm>
#include <cmath>

namespace palpate::visualizer {
namespace {

constexpr std::array<Rgb, 4> kOrganColors{
    {{253, 155, 107}, {244, 103, 192}, {170, 200, 120}, {220, 200, 180}}};

/// Largest and smallest value shown, 0 included.
std::pair<double, double> range_of(const std::vector<Curve>& curves, double since) {
  double low = 0, high = 0;
  for (const Curve& curve : curves) {
    for (std::size_t i = 0; i < curve.history->size(); ++i) {
      const auto& sample = curve.history->at(i);
      if (sample.time < since) continue;
      low = std::min(low, curve.factor * sample.value);
      high = std::max(high, curve.factor * sample.value);
    }
  }
  return {low, high};
}

void add_frame(const Axis& axis, const Box2& area, double since, Overlay& out) {
  for (double value = axis.low; value <= axis.high + 0.5 * axis.step; value += axis.step) {
    const double y = area.y + (value - axis.low) / (axis.high - axis.low) * area.height;
    const bool zero = std::abs(value) < 1e-9 * axis.step;
    out.lines.push_back({{float(area.x), float(y), float(area.right()), float(y)},
                         palette::kFrame,
                         1,
                         zero ? 1.0 : 0.45});
    out.texts.push_back(
        {area.x - 7, y, text_of("%.4g", zero ? 0.0 : value), 11, palette::kQuiet, Align::kRight});
  }
  for (double time = std::ceil(since / 2) * 2; time <= since + kPlotSpan + 1e-9; time += 2) {
    const double x = area.x + (time - since) / kPlotSpan * area.width;
    out.lines.push_back(
        {{float(x), float(area.y), float(x), float(area.top())}, palette::kFrame, 1, 0.45});
    // Beside the axis title at the right end there is no room for a number.
    if (x < area.right() - 64) {
      out.texts.push_back(
          {x, area.y - 10, text_of("%.0f", time), 11, palette::kQuiet, Align::kCenter});
    }
  }
  out.texts.push_back({area.right(), area.y - 10, "time [s]", 11, palette::kQuiet, Align::kRight});
}

void add_curve(const Curve& curve, const Axis& axis, const Box2& area, double since, Overlay& out) {
  PolylineItem line;
  line.color = curve.color;
  line.width = 1.8;
  for (std::size_t i = 0; i < curve.history->size(); ++i) {
    const auto& sample = curve.history->at(i);
    if (sample.time < since) continue;
    const double height = (curve.factor * sample.value - axis.low) / (axis.high - axis.low);
    line.points.push_back(
        static_cast<float>(area.x + (sample.time - since) / kPlotSpan * area.width));
    line.points.push_back(static_cast<float>(area.y + std::clamp(height, 0.0, 1.0) * area.height));
  }
  if (line.points.size() >= 4) out.lines.push_back(std::move(line));
}

/// 10ⁿ with n a multiple of 3 that brings `largest` to 1 … 1000.
int thousands_exponent(double largest) {
  if (!(largest > 0)) return 0;
  return 3 * static_cast<int>(std::floor(std::log10(largest) / 3));
}

void add_volume_plot(const SceneView& view, const Box2& box, double since, Overlay& out) {
  std::vector<Curve> curves;
  for (std::size_t i = 0; i < view.organs().size(); ++i) {
    curves.push_back({&view.organs()[i].volume_error, kOrganColors[i % kOrganColors.size()], 1});
  }
  const auto [low, high] = range_of(curves, since);
  const double least = 1e-9;
  const int exponent = thousands_exponent(std::max({-low, high, least}));
  std::string unit = "volume error";
  if (exponent == -6) unit += " [ppm]";
  if (exponent == -9) unit += " [ppb]";
  double factor = std::pow(10, -exponent);
  if (exponent >= -3) {
    unit += " [%]";
    factor = 100;
  }
  for (Curve& curve : curves) curve.factor = factor;
  add_plot(unit, curves, since + kPlotSpan, box, least * factor, out);
}

}  // namespace

Axis round_axis(double low, double high, double least) {
  const double span = std::max({high, 0.0}) - std::min(low, 0.0);
  const double step = round_up(std::max(span, least) / 4);
  Axis axis;
  axis.step = step;
  axis.low = step * std::floor(std::min(low, 0.0) / step + 1e-9);
  axis.high = step * std::ceil(std::max(high, 0.0) / step - 1e-9);
  if (axis.high - axis.low < 1.5 * step) axis.high = axis.low + 2 * step;
  return axis;
}

void add_plot(const std::string& title, const std::vector<Curve>& curves, double time,
              const Box2& box, double least_height, Overlay& out) {
  const Box2 area{box.x + 56, box.y + 26, std::max(1.0, box.width - 76),
                  std::max(1.0, box.height - 58)};
  const double since = time - kPlotSpan;
  const auto [low, high] = range_of(curves, since);
  const Axis axis = round_axis(low, high, least_height);
  add_frame(axis, area, since, out);
  const double title_y = area.top() + 17;
  out.texts.push_back({area.x, title_y, title, 13, palette::kText, Align::kLeft, true});
  double x = area.right();
  for (const Curve& curve : curves) {
    add_curve(curve, axis, area, since, out);
    if (curve.history->empty()) continue;
    const double grain = 1e-3 * axis.step;  // digits that the plot cannot show are not written
    const double newest = grain * std::round(curve.factor * curve.history->newest().value / grain);
    out.texts.push_back({x, title_y, text_of("%.4g", newest == 0 ? 0.0 : newest), 13, curve.color,
                         Align::kRight, true});
    x -= 62;
  }
}

void add_plots(const SceneView& view, const std::array<Box2, 3>& boxes, Overlay& out) {
  const double since = std::max(0.0, view.sim_time() - kPlotSpan);
  const double time = since + kPlotSpan;
  add_volume_plot(view, boxes[0], since, out);
  std::vector<Curve> pressures, forces;
  for (std::size_t i = 0; i < view.organs().size(); ++i) {
    pressures.push_back({&view.organs()[i].pressure, kOrganColors[i % kOrganColors.size()], 1});
  }
  for (std::size_t i = 0; i < view.probes().size(); ++i) {
    forces.push_back({&view.probes()[i].force_magnitude, probe_color(i), 1});
  }
  add_plot("pressure [Pa]", pressures, time, boxes[1], 1, out);
  add_plot("force [N]", forces, time, boxes[2], 0.1, out);
}

}  // namespace palpate::visualizer
