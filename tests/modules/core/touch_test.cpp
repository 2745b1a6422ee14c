#include "modules/core/touch.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

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

TEST_CASE("touch: a basis turns with its normal by the shortest rotation") {
  // Oracle: independent tool, Eigen's AngleAxis about their cross product; nearly opposite normals
  // too, whose cross product of 1e-3 has three digits less. Of opposite ones the invariant alone.
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  const auto direction = [&] { return Vec3(any(random), any(random), any(random)).normalized(); };
  for (int i = 0; i < 1000; ++i) {
    const Mat3 basis = contact_basis(direction());
    Vec3 normal = direction();
    if (i % 10 == 0) normal = (-basis.col(0) + 1e-3 * normal).normalized();
    if (i % 10 == 1) normal = (basis.col(0) + 1e-9 * normal).normalized();
    const Mat3 turned = turned_basis(basis, normal);
    const Vec3 axis = basis.col(0).cross(normal);
    const double angle = std::atan2(axis.norm(), basis.col(0).dot(normal));
    const Mat3 expected = Eigen::AngleAxisd(angle, axis.normalized()) * basis;
    CHECK((turned - expected).norm() < 1e-14 / std::min(1.0, axis.norm()));
    CHECK((turned.transpose() * turned - Mat3::Identity()).norm() < 1e-14);
  }
  const Mat3 basis = contact_basis(Vec3::UnitX());
  const Mat3 half_a_turn = turned_basis(basis, -Vec3::UnitX());
  CHECK((half_a_turn.col(0) + Vec3::UnitX()).norm() < 1e-14);
  CHECK((half_a_turn.transpose() * half_a_turn - Mat3::Identity()).norm() < 1e-14);
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
