#include "visualizer/overlay.h"

#include <catch2/catch.hpp>

#include "modules/core/text.h"
#include "modules/geometry/primitives.h"
#include "tests/times.h"
#include "tests/visualizer/fake_session.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::positions_of;
using visualizer::testing::topology_of;
using visualizer::testing::two_probe_scene;

namespace {

/// A session in full swing, with an error, long numbers and five processes.
SceneView busy_view() {
  SceneView view(two_probe_scene());
  const auto topology = topology_of(geometry::make_ball(0.05, 2));
  view.receive(topology);
  for (int i = 0; i <= 200; ++i) {
    auto positions = positions_of(topology, 12 + 0.1 * i);
    positions.volume *= 1 - 1.234e-5 * i;
    positions.pressure = -12345.6 * i / 200.0;
    view.receive(positions, 10 * kSecond);
    HapticForce force;
    force.header.sim_time_ns = positions.header.sim_time_ns;
    force.force = Vec3(0.02 * i, 0, 0);
    for (force.probe = 0; force.probe < 2; ++force.probe) view.receive(force);
  }
  for (const char* name : {"deformation", "collision", "haptics", "visualizer", "launcher"}) {
    ModuleStatus status;
    status.module = name;
    status.state = ModuleState::kDegraded;
    status.rate_hz = 1000;
    status.overruns = 12345;
    status.real_time_factor = 0.98;
    status.last_error = "contact model older than stale_after_s: force fades to zero";
    status.inputs = {{"contacts", 0.1234, 0, 0, 0, 0}};
    view.receive(status, 10 * kSecond);
  }
  ProbeState probe;
  view.receive(probe);
  view.refresh();
  return view;
}

Overlay overlay_of(const SceneView& view, const Interaction& interaction, int width, int height,
                   std::int64_t now_ns) {
  return make_overlay(view, make_draw_list(view, interaction.options), interaction,
                      make_layout(width, height), now_ns);
}

bool has_text(const Overlay& overlay, const std::string& part) {
  for (const TextItem& item : overlay.texts) {
    if (item.text.find(part) != std::string::npos) return true;
  }
  return false;
}

}  // namespace

/// Every pair of texts, and the picture's edges.
void check_readable(const Overlay& overlay, double width, double height) {
  const Box2 picture{0, 0, width, height};
  for (std::size_t i = 0; i < overlay.texts.size(); ++i) {
    const TextItem& text = overlay.texts[i];
    if (text.text.empty()) continue;
    const Box2 a = extent_of(text);
    INFO(width << " x " << height << ": '" << text.text << "' at " << a.x << ", " << a.y);
    CHECK(text.size >= 9);
    CHECK(picture.contains(a.x, a.y));
    CHECK(picture.contains(a.right(), a.top()));
    for (std::size_t j = 0; j < i; ++j) {
      if (overlay.texts[j].text.empty()) continue;
      INFO("and '" << overlay.texts[j].text << "'");
      CHECK_FALSE(overlap(a, extent_of(overlay.texts[j])));
    }
  }
}

TEST_CASE("overlay: no two texts overlap and none leaves the picture, from 640 x 480 to 4K",
          "[visualizer]") {
  // Oracle: brute force over all pairs, in a session in full swing, paused in slow motion with a
  // press and a long notice, and ended with help.
  SceneView view = busy_view();
  for (const auto& [width, height] :
       {std::pair{640, 480}, std::pair{800, 600}, std::pair{1024, 768}, std::pair{1280, 720},
        std::pair{1366, 768}, std::pair{1920, 1080}, std::pair{2560, 1440},
        std::pair{3840, 2160}}) {
    Interaction interaction({0.01, 0.036});
    const Layout layout = make_layout(width, height);
    interaction.camera = frontal_camera(Vec3::Zero(), 0.06, static_cast<int>(layout.scene.width),
                                        static_cast<int>(layout.scene.height));
    check_readable(overlay_of(view, interaction, width, height, 10 * kSecond), width, height);
    interaction.options.slow_motion = interaction.options.recording = true;
    interaction.say("No organ here is made of tetrahedra: 1 2 3 show its springs.");
    check_readable(overlay_of(view, interaction, width, height, 19 * kSecond), width, height);
    interaction.options.help = true;
    const Overlay helped = overlay_of(view, interaction, width, height, 19 * kSecond);
    check_readable(helped, width, height);
    for (const KeyMeaning& key : key_meanings()) CHECK(has_text(helped, key.meaning));
  }
  SessionControl pause;
  pause.header.source_time_ns = 5;
  pause.command = SessionCommand::kPause;
  view.receive(pause);
  ModuleStatus status;
  status.module = "deformation";
  status.state = ModuleState::kStopped;
  view.receive(status, 10 * kSecond);
  for (const auto& [width, height] :
       {std::pair{640, 480}, std::pair{1280, 720}, std::pair{3840, 2160}}) {
    Interaction interaction({0.01, 0.036});
    const Layout layout = make_layout(width, height);
    interaction.camera.width = static_cast<int>(layout.scene.width);
    interaction.camera.height = static_cast<int>(layout.scene.height);
    check_readable(overlay_of(view, interaction, width, height, 19 * kSecond), width, height);
  }
}

TEST_CASE("overlay: on a window of three times the size all is three times as large",
          "[visualizer]") {
  // Oracle: the same overlay, enlarged.
  const SceneView view = busy_view();
  Interaction interaction({0.01, 0.036});
  interaction.camera = frontal_camera(Vec3::Zero(), 0.06, 920, 720);
  const Overlay small = overlay_of(view, interaction, 1280, 720, 10 * kSecond);
  interaction.camera.width *= 3;
  interaction.camera.height *= 3;
  const Overlay large = overlay_of(view, interaction, 3840, 2160, 10 * kSecond);
  REQUIRE(large.texts.size() == small.texts.size());
  for (std::size_t i = 0; i < small.texts.size(); ++i) {
    CHECK(large.texts[i].text == small.texts[i].text);
    CHECK(large.texts[i].size == 3 * small.texts[i].size);
    CHECK(large.texts[i].x == Approx(3 * small.texts[i].x));
  }
}

TEST_CASE("overlay: a text is made smaller, then cut, to fit", "[visualizer]") {
  // Oracle: its extent.
  const TextItem text{0, 0, "a text of thirty letters, about", 14, {}};
  CHECK(fitted(text, 300).text == text.text);
  CHECK(fitted(text, 200).size < 14);
  CHECK(fitted(text, 200).text == text.text);
  CHECK(fitted(text, 100).text.ends_with("..."));
  for (const double width : {300.0, 200.0, 100.0, 60.0}) {
    CHECK(extent_of(fitted(text, width)).width <= width);
  }
  const TextItem greek{0, 0, "αβγδεζηθικλμνξοπρστυφχψω", 14, {}};
  for (double width = 30; width < 200; width += 5) CHECK(is_utf8(fitted(greek, width).text));
}

TEST_CASE("overlay: title, time, units of every scale are there", "[visualizer]") {
  // Oracle: the list of what a reader of the picture needs.
  const SceneView view = busy_view();
  Interaction interaction({0.01, 0.036});
  const Overlay overlay = overlay_of(view, interaction, 1280, 720, 10 * kSecond);
  for (const char* text :
       {"made_up", "t = 32.00 s", "real time x 0.98", "principal strain [%]",
        "1 N = ", "pressure [Pa]", "force [N]", "volume error", "time [s]", "h: keys"}) {
    INFO(text);
    CHECK(has_text(overlay, text));
  }
  CHECK_FALSE(has_text(overlay, "no new organ shape"));
  interaction.options.coloring = Coloring::kDisplacement;
  CHECK(has_text(overlay_of(view, interaction, 1280, 720, 10 * kSecond), "displacement [mm]"));
}

TEST_CASE("overlay: a lost deformation is marked with the age of the shape",
          "[visualizer][fault]") {
  // Oracle: the stated rule.
  const SceneView view = busy_view();
  const Interaction interaction({0.01, 0.036});
  CHECK(has_text(overlay_of(view, interaction, 1280, 720, 14 * kSecond),
                 "no new organ shape for 4.0 s"));
}

TEST_CASE("overlay: a pause is told and is not taken for a loss", "[visualizer]") {
  // Oracle: the stated rule.
  SceneView view = busy_view();
  SessionControl pause;
  pause.header.source_time_ns = 5;
  pause.command = SessionCommand::kPause;
  view.receive(pause);
  const Interaction interaction({0.01, 0.036});
  const Overlay overlay = overlay_of(view, interaction, 1280, 720, 20 * kSecond);
  CHECK(has_text(overlay, "paused"));
  CHECK_FALSE(has_text(overlay, "no new organ shape"));
}

TEST_CASE("overlay: before the surface comes it says what it waits for", "[visualizer]") {
  // Oracle: the scene's organ name.
  const SceneView view(two_probe_scene());
  const Interaction interaction({0.01, 0.036});
  CHECK(has_text(overlay_of(view, interaction, 1280, 720, kSecond),
                 "Waiting for the surface of organ 'ball'"));
}

TEST_CASE("overlay: a run that has ended says what was felt", "[visualizer]") {
  // Oracle: the forces given: 4 N at most, 0.1 s apart.
  SceneView view = busy_view();
  CHECK_FALSE(view.ended());
  SessionControl pause;
  pause.header.source_time_ns = 5;
  pause.command = SessionCommand::kPause;
  view.receive(pause);
  ModuleStatus status;
  status.module = "deformation";
  status.state = ModuleState::kStopped;
  view.receive(status, 10 * kSecond);
  CHECK(view.ended());
  const Interaction interaction({0.01, 0.036});
  const Overlay overlay = overlay_of(view, interaction, 1280, 720, 20 * kSecond);
  CHECK(has_text(overlay, "The run has ended after 32.0 s."));
  CHECK(has_text(overlay, "finger: at most 4.00 N (at 32.0 s), touched for 20.0 s"));
  CHECK(has_text(overlay, "q closes the window."));
}

TEST_CASE("overlay: help lists every key that does something", "[visualizer]") {
  // Oracle: the keys Interaction knows.
  Overlay overlay;
  add_help({0, 0, 920, 720}, overlay);
  for (const char* key :
       {"h", "c", "1 2 3", "space", "r", "s", "q", "g", "n", "m", "v", "w", "x", "t", "Home, 0"}) {
    const auto found = std::find_if(overlay.texts.begin(), overlay.texts.end(),
                                    [&](const TextItem& text) { return text.text == key; });
    INFO(key);
    CHECK(found != overlay.texts.end());
  }
}

TEST_CASE("overlay: an arrow's label is beside its tip", "[visualizer][analytic]") {
  // Oracle: projection.
  const Camera camera = frontal_camera(Vec3::Zero(), 0.1, 900, 700);
  DrawList list;
  list.arrows.push_back({Vec3::Zero(), Vec3(0.05, 0, 0), 0.001, {}, "1.00 N"});
  list.arrows.push_back({Vec3::Zero(), Vec3(-0.05, 0, 0), 0.001, {}, "2.00 N"});
  Overlay overlay;
  add_arrow_labels(list, camera, overlay);
  REQUIRE(overlay.texts.size() == 2);
  const double right = project(camera, Vec3(0.05, 0, 0))->x;
  CHECK(overlay.texts[0].x == Approx(right + 16));
  CHECK(overlay.texts[0].align == Align::kLeft);
  CHECK(overlay.texts[1].align == Align::kRight);
}

TEST_CASE("overlay: the label of an arrow that leaves the view is at its edge", "[visualizer]") {
  // Oracle: the view's box; an arrow that begins outside has none.
  const Camera camera = frontal_camera(Vec3::Zero(), 0.1, 800, 600);
  for (const Vec3& tip : {Vec3(3, 0, 0), Vec3(-3, 0, 0), Vec3(0, 0, 3), Vec3(1, 0, -3)}) {
    DrawList list;
    list.arrows.push_back({Vec3(0.01, 0, 0.01), tip, 0.001, {}, "12.50 N (mesh +12 %)"});
    Overlay overlay;
    add_arrow_labels(list, camera, overlay);
    REQUIRE(overlay.texts.size() == 1);
    const Box2 own = extent_of(overlay.texts[0]);
    CHECK(own.x >= 0);
    CHECK(own.right() <= 800);
    CHECK(own.y >= 0);
    CHECK(own.top() <= 600);
    list.arrows[0].tail = 10 * tip;
    Overlay none;
    add_arrow_labels(list, camera, none);
    CHECK(none.texts.empty());
  }
}

TEST_CASE("layout: the parts fill the window and do not overlap", "[visualizer][analytic]") {
  // Oracle: areas add up.
  for (const auto& [width, height] :
       {std::pair{1280, 720}, std::pair{640, 480}, std::pair{2560, 1440}}) {
    const Layout layout = make_layout(width, height);
    double area =
        layout.scene.width * layout.scene.height + layout.table.width * layout.table.height;
    for (const Box2& plot : layout.plots) area += plot.width * plot.height;
    CHECK(area == Approx(double(width) * height));
    CHECK(layout.scene.right() == layout.table.x);
    CHECK(layout.plots[2].y == Approx(layout.table.top()));
    CHECK(layout.plots[0].top() == Approx(height));
  }
}
