#include "visualizer/plots.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "modules/geometry/primitives.h"
#include "tests/visualizer/fake_session.h"

using namespace palpate;
using namespace palpate::visualizer;

namespace {

const PolylineItem* curve_of(const Overlay& overlay, const Rgb& color) {
  for (const PolylineItem& line : overlay.lines) {
    if (line.color == color) return &line;
  }
  return nullptr;
}

bool has_line(const Overlay& overlay, const std::string& text) {
  for (const TextItem& item : overlay.texts) {
    if (item.text == text) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("plot axis: round, holds the data and zero, two to six steps", "[visualizer]") {
  // Oracle: properties, over many ranges.
  for (double size = 1e-9; size < 1e6; size *= 1.7) {
    for (const auto& [low, high] :
         {std::pair{0.0, 1.0}, std::pair{-1.0, 0.0}, std::pair{-0.3, 1.0}, std::pair{0.9, 1.0}}) {
      const Axis axis = round_axis(low * size, high * size, 1e-12);
      CHECK(axis.low <= low * size + 1e-9 * size);
      CHECK(axis.high >= high * size - 1e-9 * size);
      CHECK(axis.low <= 0);
      CHECK(axis.high >= 0);
      const double steps = (axis.high - axis.low) / axis.step;
      CHECK(steps == Approx(std::round(steps)));
      CHECK(steps > 1.5);
      CHECK(steps < 6.5);
    }
  }
}

TEST_CASE("plot axis: has a height even for a constant zero", "[visualizer]") {
  // Oracle: the stated rule.
  const Axis axis = round_axis(0, 0, 1);
  CHECK(axis.high - axis.low >= 0.5);
  CHECK(std::isfinite(axis.step));
}

TEST_CASE("plot: a straight line in time is a straight line in the picture",
          "[visualizer][analytic]") {
  // Oracle: linear mapping: equal steps in, equal steps out, within the plot's box.
  History history;
  for (int i = 0; i <= 100; ++i) history.push(0.1 * i, 0.02 * i);
  const Rgb color{1, 2, 3};
  Overlay overlay;
  const Box2 box{100, 50, 340, 180};
  add_plot("force [N]", {{&history, color, 1}}, 10, box, 0.1, overlay);
  const PolylineItem* curve = curve_of(overlay, color);
  REQUIRE(curve != nullptr);
  REQUIRE(curve->points.size() == 2 * 101);
  const float dx = curve->points[2] - curve->points[0], dy = curve->points[3] - curve->points[1];
  CHECK(dx > 0);
  CHECK(dy > 0);
  for (std::size_t i = 2; i < curve->points.size(); i += 2) {
    CHECK(curve->points[i] - curve->points[i - 2] == Approx(dx).margin(1e-3));
    CHECK(curve->points[i + 1] - curve->points[i - 1] == Approx(dy).margin(1e-3));
    CHECK(box.contains(curve->points[i], curve->points[i + 1]));
  }
  CHECK(has_line(overlay, "force [N]"));
  CHECK(has_line(overlay, "time [s]"));
  CHECK(has_line(overlay, "2"));  // newest value, and the axis' top
}

TEST_CASE("plot: a peak of one tick of 1 kHz stays, at any width and whatever the picture's rate",
          "[visualizer]") {
  // Oracle: the height of the peak by the axis, which holds it. 10 s of 1 N with one tick of 2.5 N
  // and one of 0, taken in as many ticks at a time as a picture of 4 to 60 Hz finds waiting.
  for (const int ticks_a_picture : {17, 33, 250}) {
    for (const double width : {120.0, 340.0, 1500.0}) {
      SceneView view(visualizer::testing::two_probe_scene());
      for (int first = 0; first < 10'000; first += ticks_a_picture) {
        for (int tick = first; tick < std::min(10'000, first + ticks_a_picture); ++tick) {
          HapticForce force;
          force.header.sim_time_ns = std::int64_t{1'000'000} * tick;
          force.force = Vec3(tick == 4711 ? 2.5 : tick == 7777 ? 0 : 1, 0, 0);
          view.receive(force);
        }
      }
      Overlay overlay;
      const Rgb color{1, 2, 3};
      const Box2 box{0, 0, width, 180};
      add_plot("force [N]", {{&view.probes()[0].force_magnitude, color, 1}}, 10, box, 0.1, overlay);
      const PolylineItem* curve = curve_of(overlay, color);
      REQUIRE(curve != nullptr);
      float highest = 0, lowest = 1e9f;
      for (std::size_t i = 1; i < curve->points.size(); i += 2) {
        highest = std::max(highest, curve->points[i]);
        lowest = std::min(lowest, curve->points[i]);
      }
      const Axis axis = round_axis(0, 2.5, 0.1);
      CHECK(highest == Approx(26 + 2.5 / axis.high * (180 - 58)));
      CHECK(lowest == Approx(26));
      CHECK(view.probes()[0].greatest_force == 2.5);
      CHECK(curve->points.size() <= 2 * 3 * (std::size_t(width) + 1));  // no more than can be seen
    }
  }
}

TEST_CASE("plot: what is older than the span is not drawn", "[visualizer]") {
  // Oracle: count of samples within the span.
  History history;
  for (int i = 0; i <= 300; ++i) history.push(0.1 * i, 1);
  Overlay overlay;
  const Rgb color{1, 2, 3};
  add_plot("x", {{&history, color, 1}}, 30, {0, 0, 340, 180}, 1, overlay);
  const std::size_t points = curve_of(overlay, color)->points.size() / 2;
  CHECK(points >= 100);  // rounding may lose the one at the edge
  CHECK(points <= 101);
}

TEST_CASE("plot: a newest value too small to see is written as zero", "[visualizer]") {
  // Oracle: the stated rule: a thousandth of a grid step.
  History history;
  history.push(0, 2);
  history.push(1, 1e-7);
  Overlay overlay;
  add_plot("x", {{&history, {1, 2, 3}, 1}}, 10, {0, 0, 340, 180}, 1, overlay);
  CHECK(overlay.texts.back().text == "0");
}

TEST_CASE("volume plot: the unit follows the size of the error", "[visualizer]") {
  // Oracle: 2e-5 = 20 ppm, 0.03 = 3 %, 4e-9 = 4 ppb.
  const auto unit_at = [](double error) {
    SceneView view(visualizer::testing::two_probe_scene());
    const auto topology = visualizer::testing::topology_of(geometry::make_ball(0.05, 1));
    view.receive(topology);
    for (const double time : {0.0, 1.0}) {
      auto positions = visualizer::testing::positions_of(topology, time);
      positions.volume = positions.target_volume * (1 + error);
      view.receive(positions, 1);
    }
    Overlay overlay;
    add_plots(view, make_layout(1280, 720).plots, overlay);
    std::string title;
    for (const TextItem& text : overlay.texts) {
      if (text.text.starts_with("volume error")) title = text.text;
    }
    return title;
  };
  CHECK(unit_at(2e-5) == "volume error [ppm]");
  CHECK(unit_at(-0.03) == "volume error [%]");
  CHECK(unit_at(4e-9) == "volume error [ppb]");
  CHECK(unit_at(0) == "volume error [ppb]");
}

TEST_CASE("plot: newest values stand in the order of the curves, with their names",
          "[visualizer]") {
  // Oracle: by hand; without room for names the numbers alone, then the first of them.
  std::array<History, 3> histories;
  std::vector<Curve> curves;
  const std::array<std::string, 3> names{"stomach", "liver", "a_much_longer_name_than_the_others"};
  for (std::size_t i = 0; i < 3; ++i) {
    histories[i].push(1, double(i + 1));
    if (i < 2) curves.push_back({&histories[i], Rgb{1, 2, 3}, 1, names[i]});
  }
  const auto values = [&](double width) {
    Overlay overlay;
    add_plot("pressure [Pa]", curves, kPlotSpan, {0, 0, width, 150}, 0, overlay);
    std::vector<TextItem> found;
    for (const TextItem& text : overlay.texts) {
      if (text.color == Rgb{1, 2, 3}) found.push_back(text);
    }
    return found;
  };
  const auto two = values(400);
  REQUIRE(two.size() == 2);
  CHECK(two[0].text == "stomach 1");
  CHECK(two[1].text == "liver 2");
  CHECK(extent_of(two[0]).right() < extent_of(two[1]).x);
  CHECK(extent_of(two[1]).right() == Approx(380));
  curves.push_back({&histories[2], Rgb{1, 2, 3}, 1, names[2]});
  const auto three = values(400);
  REQUIRE(three.size() == 3);
  CHECK(three[0].text == "1");
  CHECK(three[2].text == "3");
  curves.resize(1);
  CHECK(values(400).at(0).text == "1");
}
