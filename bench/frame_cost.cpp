// What a picture costs, part by part: a shipped stomach that moves, its plots full, drawn into a
// window of 1280 x 720 on the display there is. Usage: palpate-bench-frame [MESH.ply] [PICTURES]
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/program.h"
#include "visualizer/offscreen_display.h"
#include "visualizer/renderer.h"

namespace {

using namespace palpate;
using namespace palpate::visualizer;

enum Part { kMeasures, kLists, kRendering, kPartCount };
constexpr std::array<const char*, kPartCount> kNames{"normals, strain", "lists, texts", "drawing"};

std::vector<float> flat(const std::vector<Vec3>& nodes, double swell) {
  std::vector<float> xyz;
  for (const Vec3& p : nodes) {
    for (int c = 0; c < 3; ++c) xyz.push_back(static_cast<float>(swell * p[c]));
  }
  return xyz;
}

scene::Scene one_finger() {
  scene::Scene scene;
  scene.name = "frame_cost";
  scene.organs.resize(1);
  scene.organs[0].name = "stomach";
  scene.probes.resize(1);
  scene.probes[0].name = "finger";
  scene.probes[0].shape = scene::SphereShape{0.008};
  scene.probes[0].device = scene::MouseDevice{};
  return scene;
}

SurfaceTopology topology_of(const geometry::TriangleSurface& surface) {
  SurfaceTopology out;
  out.generation = 1;
  out.name = "stomach";
  out.surface_node_count = static_cast<std::uint32_t>(surface.nodes.size());
  out.rest_positions = flat(surface.nodes, 1);
  out.triangles.assign(surface.triangles.begin(), surface.triangles.end());
  return out;
}

/// One millisecond of the session's forces.
void feel(SceneView& view, std::int64_t millisecond) {
  HapticForce force;
  force.header.sim_time_ns = millisecond * 1'000'000;
  force.force = Vec3(0, -1 - std::sin(1e-3 * double(millisecond)), 0);
  view.receive(force);
}

void move_on(SceneView& view, const geometry::TriangleSurface& surface, int picture) {
  for (int k = 0; k < 33; ++k) feel(view, 33 * picture + k);
  NodePositions moved;
  moved.generation = 1;
  moved.header.sim_time_ns = std::int64_t{33'000'000} * picture;
  moved.volume = moved.target_volume = 1e-3;
  moved.positions = flat(surface.nodes, 1 + 0.02 * std::sin(0.1 * picture));
  view.receive(std::move(moved), runtime::monotonic_now_ns());
}

/// @throws InputError without a display, or for a mesh that cannot be read
void measure(const std::string& file, int pictures) {
  const XConnection connection = connect_to_display();
  if (!connection) {
    throw InputError("no display (try: xvfb-run -s '-screen 0 1920x1200x24' …)");
  }
  const auto surface = geometry::read_surface(file, "m");
  SceneView view(one_finger());
  view.receive(topology_of(surface));
  ProbeState finger;
  finger.pose.position = Vec3(0.03, -0.06, 0);
  view.receive(finger);
  Renderer renderer({.window = true}, {geometry::make_ball(0.008, 3)});
  Interaction interaction({0.008});
  interaction.camera = frontal_camera(view.center(), 1.25 * view.radius(), 920, 720);

  std::array<double, kPartCount> spent{};
  std::clock_t began = 0;
  for (int i = -10; i < pictures; ++i) {  // the first ones compile shaders
    move_on(view, surface, i + 10);
    renderer.take_events();
    if (i == 0) began = std::clock();
    std::array<std::int64_t, 4> at{};  // a time before and behind each part
    static_assert(at.size() == kPartCount + 1);
    at[0] = runtime::monotonic_now_ns();
    view.refresh();
    at[1] = runtime::monotonic_now_ns();
    const Layout layout = make_layout(renderer.width(), renderer.height());
    const DrawList list = make_draw_list(view, interaction.options);
    const Overlay overlay = make_overlay(view, list, interaction, layout, at[1]);
    at[2] = runtime::monotonic_now_ns();
    renderer.draw(list, overlay, interaction.camera);
    at[3] = runtime::monotonic_now_ns();
    for (int k = 0; k < kPartCount && i >= 0; ++k) spent[k] += seconds_from_ns(at[k + 1] - at[k]);
  }
  double all = 0;
  std::printf("%s: %zu nodes, %d pictures of %d x %d\n", file.c_str(), surface.nodes.size(),
              pictures, renderer.width(), renderer.height());
  for (int k = 0; k < kPartCount; ++k) {
    std::printf("  %-16s %7.2f ms\n", kNames[k], 1e3 * spent[k] / pictures);
    all += spent[k];
  }
  const double worked = double(std::clock() - began) / CLOCKS_PER_SEC;
  std::printf("  %-16s %7.2f ms: %.1f pictures/s; of all threads' processor time %.2f ms\n",
              "together", 1e3 * all / pictures, pictures / all, 1e3 * worked / pictures);
}

}  // namespace

int main(int argc, char** argv) {
  runtime::Program program("What the parts of a picture cost in a window", "palpate-bench-frame");
  std::string file = "scenes/meshes/stomach.ply";
  int pictures = 150;
  program.add("MESH", file, "Surface of the organ, in metres").shows_default();
  program.add("PICTURES", pictures, "How many are drawn").range(1, 100000).shows_default();
  return program.run(argc, argv, [&] {
    measure(file, pictures);
    return kExitDone;
  });
}
