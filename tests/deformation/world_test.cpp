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

TEST_CASE("deformation world: the local law goes on with a slow press") {
  // Oracle: the world's own force a period later. 20 % of what it grew by: a plate meets its nodes
  // one by one.
  auto organ = ball_organ();
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.03)});
  organ.tissue.drag = 10;
  auto world = ball_world(3, 1, organ);
  const double way = 10e-3 * kPeriod;
  double height = kBallRadius;
  const auto press = [&] {
    height -= way;  // 10 mm/s
    world.set_contacts(plate_contacts(world, 0, height, 1, 2e-3));
    world.set_probe(0, Pose{Vec3(0, 0, height), Quat::Identity()});
    world.advance(kPeriod);
  };
  std::vector<Vec3> forces;
  while (height > kBallRadius - 0.015) {
    press();
    forces.push_back(world.force(0));
  }
  const LocalLaw law = world.local_law(0);
  REQUIRE(law.touching());
  CHECK((law.anchor.position - Vec3(0, 0, height)).norm() < 1e-12);
  CHECK((law.force() - world.force(0)).norm() < 1e-12 * world.force(0).norm());
  CHECK(law.period == kPeriod);
  CHECK(law.validity_radius > 0);
  for (const LawRow& row : law.rows) {
    CHECK(row.normal.z() == Approx(1).epsilon(1e-6));
    if (row.force.z() > 0) CHECK(row.velocity.z() == Approx(-10e-3).epsilon(0.01));
  }
  // Definition: of the last three periods, so that one that chatters counts for a third.
  const Vec3 &now = forces.back(), &then = forces[forces.size() - 4];
  CHECK(law.growth * kPeriod == Approx((now - then).dot(now) / now.squaredNorm() / 3));
  press();
  const double grown = (world.force(0) - law.force()).z();
  CHECK(law.growth * kPeriod * law.force().z() == Approx(grown).epsilon(0.2));
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

TEST_CASE("deformation world: nodes told as a face are held as told one by one") {
  // Oracle: the same contacts in a list. The plane is turned, so that P is not W.
  auto one_by_one = ball_world(3, 1), as_face = ball_world(3, 1);
  Pose pose;
  pose.rotation = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  double height = kBallRadius;
  for (int step = 0; step < 30; ++step) {
    height -= 2e-4;
    pose.position = Vec3(0, 0, height);
    const ContactSet listed = plate_contacts(one_by_one, 0, height, 1, 2e-3);
    ContactSet list = listed, faces;
    list.probe_pose = faces.probe_pose = pose;
    FaceContacts face;
    face.point_P = Vec3::Zero();
    face.normal_P = pose.rotation.conjugate() * Vec3::UnitZ();
    for (Contact& contact : list.contacts) {
      const Vec3 at = contact.point_P + Vec3(0, 0, height);
      contact.point_P = pose.to_body(at);
      contact.normal_P = face.normal_P;
      int corner = 0;
      contact.barycentric.maxCoeff(&corner);
      faces.face_nodes.push_back(
          one_by_one.model(0).triangles[contact.triangle][std::size_t(corner)]);
    }
    face.node_count = static_cast<std::uint32_t>(faces.face_nodes.size());
    if (face.node_count > 0) faces.faces.push_back(face);
    one_by_one.set_contacts(list);
    as_face.set_contacts(faces);
    one_by_one.set_probe(0, pose);
    as_face.set_probe(0, pose);
    CHECK(one_by_one.advance(kPeriod).contacts_unsolved == 0);
    CHECK(as_face.advance(kPeriod).contacts_unsolved == 0);
  }
  CHECK(one_by_one.force(0).norm() > 0.01);
  CHECK((one_by_one.force(0) - as_face.force(0)).norm() < 1e-5 * one_by_one.force(0).norm());
  double apart = 0;
  for (std::size_t i = 0; i < one_by_one.positions(0).size(); ++i) {
    apart = std::max(apart, (one_by_one.positions(0)[i] - as_face.positions(0)[i]).norm());
  }
  CHECK(apart < 1e-8);  // positions of plate_contacts() are float32: 4e-9 m of 5 cm
}

TEST_CASE("deformation world: faces that name nothing here, or too many nodes, are ignored") {
  // Oracle: definition.
  auto world = ball_world(1, 1);
  ContactSet contacts;
  contacts.faces.resize(2);
  contacts.faces[0].organ = 7;
  contacts.faces[0].node_count = 2;
  contacts.faces[1].node_count = 99;
  contacts.face_nodes = {0, 1, 1u << 30};
  world.set_contacts(contacts);
  CHECK_FALSE(world.advance(kPeriod).diverged);
  CHECK(world.force(0).isZero(0));
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

TEST_CASE("deformation world: contacts that name nothing here are ignored") {
  // Oracle: definition.
  auto world = ball_world(1, 1);
  Contacts contacts;
  Contact contact;
  contact.barycentric = Vec3(1, 0, 0);
  contact.organ = 7;
  contacts.contacts.push_back(contact);
  contact.organ = 0;
  contact.triangle = 1u << 30;
  contacts.contacts.push_back(contact);
  world.set_contacts(contacts);
  contacts.probe = 99;
  world.set_contacts(contacts);
  world.set_probe(99, Pose{Vec3::Zero(), Quat::Identity()});
  world.advance(kPeriod);
  NodePositions nodes;
  deformation::write_node_positions(world, 0, nodes);
  CHECK(nodes.volume == Approx(nodes.target_volume).epsilon(1e-12));
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
