// Organs and plates the deformation tests share.
#pragma once

#include <string>

#include "deformation/model/organ_model.h"
#include "deformation/world.h"
#include "modules/geometry/primitives.h"

namespace palpate::deformation::testing {

/// Ball of 5 cm radius, E 10 kPa, wall 3 mm.
inline scene::Organ ball_organ() {
  scene::Organ organ;
  organ.name = "ball";
  organ.tissue.youngs_modulus = 10e3;
  organ.tissue.wall_thickness = 3e-3;
  return organ;
}

inline constexpr double kBallRadius = 0.05;

inline OrganModel ball_model(int levels, const scene::Organ& organ = ball_organ(),
                             const Vec3& gravity = Vec3::Zero()) {
  return build_organ_model(organ, gravity, geometry::make_ball(kBallRadius, levels));
}

inline scene::Scene ball_scene(std::size_t probes, const scene::Organ& organ = ball_organ()) {
  scene::Scene scene;
  scene.organs.push_back(organ);
  for (std::size_t i = 0; i < probes; ++i) {
    scene.probes.push_back(
        {"plate" + std::to_string(i), scene::PlaneShape{}, 0.0, scene::ScriptedDevice{}});
  }
  return scene;
}

/// Contacts of a plate at z = height with every node of the organ near it, one row per node.
/// @param side  +1: the plate is above and pushes down, −1: below and pushes up
inline Contacts plate_contacts(const DeformationWorld& world, std::uint32_t probe, double height,
                               int side, double margin) {
  const SurfaceTopology& topology = world.topology(0);
  NodePositions nodes;
  world.write_node_positions(0, nodes);
  Contacts contacts;
  contacts.probe = probe;
  contacts.probe_pose.position = Vec3(0, 0, height);
  std::vector<bool> done(topology.surface_node_count, false);
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::size_t node = topology.triangles[t][static_cast<std::size_t>(corner)];
      const Vec3 p(nodes.positions[3 * node], nodes.positions[3 * node + 1],
                   nodes.positions[3 * node + 2]);
      const double gap = side * (height - p.z());
      if (done[node] || gap > margin) continue;
      done[node] = true;
      Contact contact;
      contact.triangle = t;
      contact.barycentric[corner] = 1;
      contact.point_on_probe = Vec3(p.x(), p.y(), height);
      contact.normal = Vec3(0, 0, side);
      contact.gap = gap;
      contacts.contacts.push_back(contact);
    }
  }
  return contacts;
}

inline ProbeState probe_at(std::uint32_t probe, const Vec3& position) {
  ProbeState state;
  state.probe = probe;
  state.pose.position = position;
  return state;
}

}  // namespace palpate::deformation::testing
