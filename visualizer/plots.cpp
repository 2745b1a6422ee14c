#include "visualizer/plots.h"

#include <algorithm>
#include <cmath>

#include "modules/core/text.h"

namespace palpate::visualizer {
namespace {

constexpr std::array<Rgb, 4> kOrganColors{
    {{253, 155, 107}, {244, 103, 192}, {170, 200, 120}, {220, 200, 180}}};

constexpr double kNumbers = 56;  // room for the vertical axis' [pixels]

/// Four digits, more only of whole numbers.
std::string number_text(double value) {
  return text_of(std::abs(value) >= 1e4 && std::abs(value) < 1e6 ? "%.0f" : "%.4g", value);
}

/// Largest and smallest value shown, 0 included.
std::pair<double, double> range_of(const std::vector<Curve>& curves, double since) {
  double low = 0, high = 0;
  for (const Curve& curve : curves) {
    for (std::size_t i = 0; i < curve.history->size(); ++i) {
      const auto& sample = curve.history->at(i);
      if (sample.time < since) continue;
      low = std::min(low, curve.factor * sample.least);
      high = std::max(high, curve.factor * sample.greatest);
    }
  }
  return {low, high};
}

void add_frame(const Axis& axis, const Box2& area, double since, Overlay& out) {
  constexpr double kRoom = 15;  // from one number to the next [pixels]
  const double apart = axis.step / (axis.high - axis.low) * area.height;
  const int every = std::max(1, static_cast<int>(std::ceil(kRoom / apart)));
  const int lowest = static_cast<int>(std::lround(axis.low / axis.step));
  const int highest = static_cast<int>(std::lround(axis.high / axis.step));
  for (int i = lowest; i <= highest; ++i) {
    const double value = i * axis.step;
    const double y = area.y + (value - axis.low) / (axis.high - axis.low) * area.height;
    out.lines.push_back({{float(area.x), float(y), float(area.right()), float(y)},
                         palette::kFrame,
                         1,
                         i == 0 ? 1.0 : 0.45});
    if (i % every != 0) continue;
    out.texts.push_back(fitted(
        {area.x - 7, y, number_text(value), 11, palette::kQuiet, Align::kRight}, kNumbers - 9));
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

/// Column by column of the picture: where the curve enters, its least, its greatest, where it
/// leaves. So every peak is drawn, and no more points than the picture can show.
void add_curve(const Curve& curve, const Axis& axis, const Box2& area, double since, Overlay& out) {
  PolylineItem line;
  line.color = curve.color;
  line.width = 1.8;
  const auto point = [&](double x, double value) {
    const double height = (curve.factor * value - axis.low) / (axis.high - axis.low);
    line.points.push_back(static_cast<float>(x));
    line.points.push_back(static_cast<float>(area.y + std::clamp(height, 0.0, 1.0) * area.height));
  };
  History::Sample column;
  double column_x = 0;
  const auto finish = [&] {
    if (column.least == column.greatest) return point(column_x, column.value);
    point(column_x, column.least);
    point(column_x, column.greatest);
    point(column_x, column.value);
  };
  bool begun = false;
  for (std::size_t i = 0; i < curve.history->size(); ++i) {
    const auto& sample = curve.history->at(i);
    if (sample.time < since) continue;
    const double x = area.x + (sample.time - since) / kPlotSpan * area.width;
    if (begun && std::floor(x) == std::floor(column_x)) {
      column = {sample.time, sample.value, std::min(column.least, sample.least),
                std::max(column.greatest, sample.greatest)};
    } else {
      if (begun) finish();
      column = sample;
      column_x = x;
    }
    begun = true;
  }
  if (begun) finish();
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
    curves.push_back({&view.organs()[i].volume_error, kOrganColors[i % kOrganColors.size()], 1,
                      view.scene().organs[i].name});
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

constexpr double kBetweenValues = 8;

/// Of all curves that have one, from the left; of several with their names, if `named`.
std::vector<TextItem> newest_values(const std::vector<Curve>& curves, const Axis& axis, double y,
                                    bool named) {
  std::vector<TextItem> values;
  for (const Curve& curve : curves) {
    if (curve.history->empty()) continue;
    const double grain = 1e-3 * axis.step;  // digits that the plot cannot show are not written
    const double newest = grain * std::round(curve.factor * curve.history->newest().value / grain);
    std::string text = number_text(newest == 0 ? 0.0 : newest);
    if (named && curves.size() > 1 && !curve.name.empty()) text.insert(0, curve.name + " ");
    values.push_back({0, y, text, 13, curve.color, Align::kLeft, true});
  }
  return values;
}

double width_of(const std::vector<TextItem>& texts) {
  double width = texts.empty() ? 0 : -kBetweenValues;
  for (const TextItem& text : texts) width += extent_of(text).width + kBetweenValues;
  return width;
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
  const Box2 area{box.x + kNumbers, box.y + 26, std::max(1.0, box.width - kNumbers - 20),
                  std::max(1.0, box.height - 58)};
  const double since = time - kPlotSpan;
  const auto [low, high] = range_of(curves, since);
  const Axis axis = round_axis(low, high, least_height);
  add_frame(axis, area, since, out);
  const double title_y = area.top() + 17;
  const TextItem heading =
      fitted({area.x, title_y, title, 13, palette::kText, Align::kLeft, true}, 0.72 * area.width);
  out.texts.push_back(heading);
  for (const Curve& curve : curves) add_curve(curve, axis, area, since, out);
  const double room = area.right() - extent_of(heading).right() - kBetweenValues;
  auto values = newest_values(curves, axis, title_y, true);
  if (width_of(values) > room) values = newest_values(curves, axis, title_y, false);
  while (!values.empty() && width_of(values) > room) values.pop_back();
  double x = area.right() - width_of(values);
  for (TextItem& value : values) {
    value.x = x;
    x += extent_of(value).width + kBetweenValues;
    out.texts.push_back(std::move(value));
  }
}

void add_plots(const SceneView& view, const std::array<Box2, 3>& boxes, Overlay& out) {
  const double since = std::max(0.0, view.sim_time() - kPlotSpan);
  const double time = since + kPlotSpan;
  add_volume_plot(view, boxes[0], since, out);
  std::vector<Curve> pressures, forces;
  for (std::size_t i = 0; i < view.organs().size(); ++i) {
    pressures.push_back({&view.organs()[i].pressure, kOrganColors[i % kOrganColors.size()], 1,
                         view.scene().organs[i].name});
  }
  for (std::size_t i = 0; i < view.probes().size(); ++i) {
    forces.push_back(
        {&view.probes()[i].force_magnitude, probe_color(i), 1, view.probes()[i].description.name});
  }
  add_plot("pressure [Pa]", pressures, time, boxes[1], 1, out);
  add_plot("force [N]", forces, time, boxes[2], 0.1, out);
}

}  // namespace palpate::visualizer
