// Messages of a made-up session, for tests without other processes.
#pragma once

#include <cmath>
#include <vector>

#include "modules/geometry/triangle_surface.h"
#include "modules/messages/messages.h"
#include "modules/scene/scene.h"
#include "visualizer/camera.h"

namespace palpate::visualizer::testing {

/// One organ, and probes in this order: sphere (device scripted), capsule (device mouse).
inline scene::Scene two_probe_scene() {
  scene::Scene scene;
  scene.name = "made_up";
  scene.organs.resize(1);
  scene.organs[0].name = "ball";
  scene.probes.resize(2);
  scene.probes[0].name = "finger";
  scene.probes[0].shape = scene::SphereShape{0.01};
  scene.probes[0].device = scene::ScriptedDevice{};
  scene.probes[1].name = "rod";
  scene.probes[1].shape = scene::CapsuleShape{0.006, 0.06};
  scene.probes[1].device = scene::MouseDevice{Vec3(0.12, 0, 0), Quat::Identity()};
  return scene;
}

/// Looks down and to the left at a place beside the origin.
inline Camera skewed_camera() {
  Camera camera;
  camera.position = Vec3(0.3, -0.4, 0.2);
  camera.target = Vec3(0.02, 0.03, -0.05);
  return camera;
}

inline std::vector<float> flat(const std::vector<Vec3>& nodes) {
  std::vector<float> xyz;
  for (const Vec3& p : nodes) {
    for (int c = 0; c < 3; ++c) xyz.push_back(static_cast<float>(p[c]));
  }
  return xyz;
}

/// The surface as an organ with one virtual node at its centroid, structural springs on its edges,
/// and inner springs to the virtual node.
inline SurfaceTopology topology_of(const geometry::TriangleSurface& surface,
                                   std::uint32_t generation = 1) {
  SurfaceTopology out;
  out.generation = generation;
  out.name = "ball";
  out.surface_node_count = static_cast<std::uint32_t>(surface.nodes.size());
  out.rest_positions = flat(surface.nodes);
  const Vec3 center = geometry::solid_centroid(surface);
  for (int c = 0; c < 3; ++c) out.rest_positions.push_back(static_cast<float>(center[c]));
  out.triangles.assign(surface.triangles.begin(), surface.triangles.end());
  for (const auto& [a, b] : geometry::edges_of(surface.triangles)) {
    out.springs.push_back({a, b, SpringFamily::kStructural});
  }
  for (std::uint32_t i = 0; i < out.surface_node_count; ++i) {
    out.springs.push_back({i, out.surface_node_count, SpringFamily::kInner});
  }
  return out;
}

/// Positions of that topology at rest, to be changed by the test.
inline NodePositions positions_of(const SurfaceTopology& topology, double seconds = 0) {
  NodePositions out;
  out.header.sequence = 1;
  out.header.sim_time_ns = static_cast<std::int64_t>(1e9 * seconds);
  out.organ = topology.organ;
  out.generation = topology.generation;
  out.volume = out.target_volume = 1e-3;
  out.positions = topology.rest_positions;
  return out;
}

}  // namespace palpate::visualizer::testing
