// Contacts with a plate as collision would tell them, found node by node.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "deformation/organ_messages.h"
#include "deformation/world.h"

namespace palpate::deformation::testing {

/// Contacts of a plate at z = height with every node of the world's first organ near it, one each.
/// @param side  +1: the plate is above and pushes down, −1: below and pushes up
/// @param margin  nodes whose gap is no more than this [m]
inline ContactSet plate_contacts(const DeformationWorld& world, std::uint32_t probe, double height,
                                 int side, double margin) {
  const SurfaceTopology& topology = surface_message(world, 0);
  NodePositions nodes;
  write_node_positions(world, 0, nodes);
  std::vector<std::pair<std::uint32_t, int>> corners(topology.surface_node_count);
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      corners[topology.triangles[t][static_cast<std::size_t>(k)]] = {t, k};
    }
  }
  ContactSet contacts;
  contacts.probe = probe;
  contacts.probe_pose.position = Vec3(0, 0, height);
  for (std::size_t node = 0; node < corners.size(); ++node) {
    const float* p = &nodes.positions[3 * node];
    Contact contact;
    contact.gap = side * (height - p[2]);
    if (contact.gap > margin) continue;
    contact.triangle = corners[node].first;
    contact.barycentric = Vec3::Unit(corners[node].second);
    contact.point_P = Vec3(p[0], p[1], 0);
    contact.normal_P = Vec3(0, 0, side);
    contacts.contacts.push_back(contact);
  }
  return contacts;
}

}  // namespace palpate::deformation::testing
