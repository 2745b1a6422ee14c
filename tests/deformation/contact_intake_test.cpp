#include "deformation/contact_intake.h"

#include <catch2/catch.hpp>

#include "deformation/world.h"
#include "organs.h"

namespace palpate::deformation {
namespace {

DeformationWorld intake_world(int levels) {
  return DeformationWorld(testing::ball_scene(1, testing::ball_organ()),
                          {geometry::make_ball(testing::kBallRadius, levels)});
}

TEST_CASE("contact intake: nodes told as a face are held as told one by one") {
  // Oracle: the same contacts in a list. The plane is turned, so that P is not W.
  auto one_by_one = intake_world(3), as_face = intake_world(3);
  Pose pose;
  pose.rotation = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  double height = testing::kBallRadius;
  for (int step = 0; step < 30; ++step) {
    height -= 2e-4;
    pose.position = Vec3(0, 0, height);
    const ContactSet listed = testing::plate_contacts(one_by_one, 0, height, 1, 2e-3);
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
    CHECK(one_by_one.advance(testing::kPeriod).contacts_unsolved == 0);
    CHECK(as_face.advance(testing::kPeriod).contacts_unsolved == 0);
  }
  CHECK(one_by_one.force(0).norm() > 0.01);
  CHECK((one_by_one.force(0) - as_face.force(0)).norm() < 1e-5 * one_by_one.force(0).norm());
  double apart = 0;
  for (std::size_t i = 0; i < one_by_one.positions(0).size(); ++i) {
    apart = std::max(apart, (one_by_one.positions(0)[i] - as_face.positions(0)[i]).norm());
  }
  CHECK(apart < 1e-8);  // positions of testing::plate_contacts() are float32: 4e-9 m of 5 cm
}

TEST_CASE("contact intake: faces that name nothing here, or too many nodes, are ignored") {
  // Oracle: definition.
  auto world = intake_world(1);
  ContactSet contacts;
  contacts.faces.resize(2);
  contacts.faces[0].organ = 7;
  contacts.faces[0].node_count = 2;
  contacts.faces[1].node_count = 99;
  contacts.face_nodes = {0, 1, 1u << 30};
  world.set_contacts(contacts);
  CHECK_FALSE(world.advance(testing::kPeriod).diverged);
  CHECK(world.force(0).isZero(0));
}

TEST_CASE("contact intake: contacts that name nothing here are ignored") {
  // Oracle: definition.
  auto world = intake_world(1);
  ContactSet contacts;
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
  world.advance(testing::kPeriod);
  const OrganReading reading = world.read(0);
  CHECK(reading.volume == Approx(reading.target_volume).epsilon(1e-12));
}

}  // namespace
}  // namespace palpate::deformation
