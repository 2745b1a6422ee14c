#include "modules/core/touch.h"

#include <catch2/catch.hpp>
#include <limits>

using namespace palpate;

TEST_CASE("touch: a node on a face has the contact of its plane") {
  // Oracle: analytic; the plane z = 0.3, tissue below it.
  FaceContacts face;
  face.organ = 3;
  face.point_P = Vec3(5, -7, 0.3);
  const Contact contact = contact_on_face(face, Vec3(0.1, 0.2, 0.5));
  CHECK(contact.organ == 3);
  CHECK(contact.gap == Approx(-0.2).epsilon(1e-15));
  CHECK((contact.point_P - Vec3(0.1, 0.2, 0.3)).norm() < 1e-15);
  CHECK(contact.normal_P == Vec3::UnitZ());
}

TEST_CASE("touch: the deepest of contacts and faces, how many places, and none") {
  // Oracle: by hand.
  ContactSet set;
  CHECK(set.empty());
  CHECK(set.deepest_gap() == std::numeric_limits<double>::infinity());
  set.contacts.resize(2);
  set.contacts[1].gap = -0.25;
  set.faces.resize(1);
  set.faces[0].gap = -0.5;
  set.face_nodes = {4, 5, 6};
  set.truncated = true;
  CHECK(set.deepest_gap() == -0.5);
  CHECK(set.count() == 5);
  set.clear();
  CHECK(set.empty());
  CHECK(set.count() == 0);
  CHECK_FALSE(set.truncated);
}
