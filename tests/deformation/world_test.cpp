#include "deformation/world.h"
#include "deformation/organ_messages.h"

#include <catch2/catch.hpp>
#include <limits>
#include <set>

#include "organs.h"

namespace palpate::deformation {
namespace {

using testing::ball_organ;
using testing::ball_scene;
using testing::kBallRadius;
using testing::kPeriod;
using testing::plate_contacts;

DeformationWorld ball_world(int levels, std::size_t probes,
                            const scene::Organ& organ = ball_organ()) {
  return DeformationWorld(ball_scene(probes, organ), {geometry::make_ball(kBallRadius, levels)});
}

TEST_CASE("deformation world: a probe that leaves gives no force") {
  // Oracle: definition of a contact.
  auto world = ball_world(2, 1);
  double height = kBallRadius + 1e-3;
  ContactModel model;
  for (int direction : {-1, 1}) {
    for (int cycle = 0; cycle < 200; ++cycle) {
      height += direction * 0.04 * kPeriod;
      world.set_contacts(plate_contacts(world, 0, height, 1, 2e-3));
      world.set_probe(0, Pose{Vec3(0, 0, height), Quat::Identity()});
      world.advance(kPeriod);
      model = deformation::contact_model_message(world, 0);
      CHECK(model.force().z() >= 0);
    }
    CHECK(model.touching() == (direction < 0));
  }
  CHECK(model.force() == Vec3::Zero());
  CHECK(model.stiffness == Mat3::Zero());
}

TEST_CASE("deformation world: a probe that jumps drops its contacts and says so") {
  // Oracle: kMaxProbeSpeed.
  auto world = ball_world(2, 1);
  world.set_probe(0, Pose{Vec3(0, 0, 0.049), Quat::Identity()});
  world.set_contacts(plate_contacts(world, 0, 0.049, 1, 2e-3));
  CHECK_FALSE(world.advance(kPeriod).probe_jumped);
  world.set_probe(0, Pose{Vec3(0, 0, -0.2), Quat::Identity()});
  CHECK(world.advance(kPeriod).probe_jumped);
  const LocalLaw model = world.local_law(0);
  CHECK_FALSE(model.touching());
  NodePositions nodes;
  deformation::write_node_positions(world, 0, nodes);
  CHECK(nodes.kinetic_energy < 1e-2);
}

TEST_CASE(
    "deformation world: contacts far from their tissue or probe are refused, and it says so") {
  // Oracle: a torque about the probe's origin that is a number, and no more than any contact there
  // is could exert.
  for (const bool far_probe : {false, true}) {
    auto world = ball_world(2, 1);
    world.set_probe(0, Pose{Vec3(0, 0, 0.049), Quat::Identity()});
    ContactSet contacts = plate_contacts(world, 0, 0.049, 1, 2e-3);
    REQUIRE(contacts.contacts.size() > 1);
    contacts.contacts.back().point_P = Vec3(1e300, 0, 0);
    if (far_probe) contacts.probe_pose.position = Vec3(0, 1e308, 0);
    world.set_contacts(contacts);
    CHECK(world.advance(kPeriod).contact_refused);
    const LocalLaw model = world.local_law(0);
    CHECK(model.touching() != far_probe);
    CHECK(model.torque().norm() <= 0.05 * model.force().norm());
    CHECK_FALSE(world.advance(kPeriod).contact_refused);
  }
}

TEST_CASE("deformation world: contacts that cannot all hold are counted as not solved") {
  // Oracle: geometry: plates that close on one node from both sides leave it no place. At 0.1 m/s
  // each, it ends every step deeper in one of them by what one goes.
  auto world = ball_world(1, 2);
  const Vec3 node = world.positions(0)[world.model(0).triangles[0][0]];
  for (const std::uint32_t probe : {0u, 1u}) {
    ContactSet contacts;
    contacts.probe = probe;
    Contact contact;
    contact.barycentric = Vec3::UnitX();
    contact.normal_P = probe == 0 ? Vec3::UnitZ() : Vec3(-Vec3::UnitZ());
    contact.point_P = node;
    contacts.contacts.push_back(contact);
    world.set_probe(probe, Pose{});
    world.set_contacts(contacts);
  }
  CHECK(world.advance(kPeriod).contacts_unsolved == 0);
  for (int k = 1; k <= 5; ++k) {
    const Vec3 closed = 0.1 * k * kPeriod * Vec3::UnitZ();
    world.set_probe(0, Pose{-closed, Quat::Identity()});
    world.set_probe(1, Pose{closed, Quat::Identity()});
    CHECK(world.advance(kPeriod).contacts_unsolved > 0);
  }
}

TEST_CASE("deformation world: a not finite contact restores the last good state and says so") {
  // Oracle: definition of AdvanceReport::diverged.
  auto world = ball_world(1, 1);
  world.set_probe(0, Pose{Vec3(0, 0, kBallRadius), Quat::Identity()});
  auto contacts = plate_contacts(world, 0, kBallRadius, 1, 2e-3);
  REQUIRE(!contacts.contacts.empty());
  contacts.contacts[0].normal_P = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  world.set_contacts(contacts);
  CHECK(world.advance(kPeriod).diverged);
  NodePositions nodes;
  deformation::write_node_positions(world, 0, nodes);
  for (const float x : nodes.positions) REQUIRE(std::isfinite(x));
  CHECK(std::isfinite(nodes.pressure));
  world.set_contacts(Contacts{});
  CHECK_FALSE(world.advance(kPeriod).diverged);
}

TEST_CASE("deformation world: reset goes back to rest under a new generation") {
  // Oracle: definition.
  auto world = ball_world(2, 1);
  NodePositions rest, moved, again;
  deformation::write_node_positions(world, 0, rest);
  world.set_probe(0, Pose{Vec3(0, 0, 0.045), Quat::Identity()});
  world.set_contacts(plate_contacts(world, 0, 0.045, 1, 2e-3));
  for (int i = 0; i < 10; ++i) world.advance(kPeriod);
  deformation::write_node_positions(world, 0, moved);
  CHECK(moved.positions != rest.positions);
  world.reset();
  deformation::write_node_positions(world, 0, again);
  CHECK(again.positions == rest.positions);
  CHECK(again.generation == rest.generation + 1);
  CHECK(world.time() == 0);
}

TEST_CASE("deformation world: sub-steps are whole, stable and cover the period") {
  // Oracle: definition.
  auto world = ball_world(3, 1);
  for (const double period : {1e-3, 4e-3, 20e-3}) {
    const int substeps = world.substeps(0, period);
    CHECK(period / substeps <= world.stable_step(0));
    if (substeps > 1) CHECK(period / (substeps - 1) > world.stable_step(0));
  }
}

TEST_CASE("deformation world: a solid's topology names each edge of its tetrahedra once") {
  // Oracle: pairs of corners, by brute force. A tetrahedron cut into four about its middle: 6 + 4.
  geometry::OrganShape shape(geometry::make_tetrahedron(0.1));
  shape.inner_nodes = {Vec3::Zero()};
  for (const auto& [a, b, c] : shape.surface.triangles) shape.tetrahedra.push_back({a, c, b, 4});
  scene::Organ organ = ball_organ();
  organ.model = "nodal_pressure";
  const DeformationWorld world(ball_scene(1, organ), {shape});
  const auto topology = deformation::surface_message(world, 0);
  std::set<std::array<std::uint32_t, 2>> expected, named;
  for (const auto& corners : world.model(0).mesh().tetrahedra) {
    for (const auto i : corners) {
      for (const auto j : corners) {
        if (i < j) expected.insert({i, j});
      }
    }
  }
  for (const auto& edge : topology.springs) {
    CHECK(edge.family == SpringFamily::kInner);
    named.insert({edge.node_a, edge.node_b});
  }
  CHECK(expected.size() == 10);
  CHECK(named == expected);
  CHECK(topology.springs.size() == expected.size());
}

TEST_CASE("deformation world: the topology names nodes, triangles, springs and fixed nodes") {
  // Oracle: counts of a closed genus-0 surface, E = 3 V − 6.
  auto organ = ball_organ();
  organ.fixed.push_back(scene::SphereRegion{Vec3(0, 0, -0.05), 0.02});
  const auto world = ball_world(2, 1, organ);
  const auto& topology = deformation::surface_message(world, 0);
  CHECK(topology.name == "ball");
  CHECK(topology.surface_node_count == 162);
  CHECK(topology.triangles.size() == 320);
  CHECK(topology.rest_positions.size() == 3 * (162 + organ.springs.virtual_nodes));
  CHECK(!topology.fixed_nodes.empty());
  std::size_t structural = 0, inner = 0;
  for (const auto& spring : topology.springs) {
    structural += spring.family == SpringFamily::kStructural;
    inner += spring.family == SpringFamily::kInner;
  }
  CHECK(structural == 3 * 162 - 6);
  CHECK(inner == 162);
}

}  // namespace
}  // namespace palpate::deformation
