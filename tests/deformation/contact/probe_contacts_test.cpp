#include "deformation/contact/probe_contacts.h"

#include <catch2/catch.hpp>

#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

constexpr double kPeriod = 4e-3;

Pose pose_at(const Vec3& position, double turn_about_z = 0) {
  return {position, Quat(Eigen::AngleAxisd(turn_about_z, Vec3::UnitZ()))};
}

/// One contact per named triangle, all at p with normal n, in P.
std::vector<Contact> contacts_on(std::vector<std::uint32_t> triangles, const Vec3& p,
                                 const Vec3& n) {
  std::vector<Contact> contacts;
  for (const auto triangle : triangles) {
    Contact contact;
    contact.triangle = triangle;
    contact.barycentric = Vec3(0.2, 0.3, 0.5);
    contact.point_P = p;
    contact.normal_P = n;
    contacts.push_back(contact);
  }
  return contacts;
}

scene::Probe plate(double friction) {
  return {"plate", scene::PlaneShape{}, friction, scene::ScriptedDevice{}};
}

struct Ball {
  OrganModel model = testing::ball_model(1);
  OrganState state = rest_state(model);
};

TEST_CASE("probe contacts: a contact moves rigidly with its probe") {
  // Oracle: rigid motion by hand; a quarter turn takes +x to +y.
  const Ball ball;
  ProbeContacts probe(plate(0.3));
  probe.set_pose(pose_at(Vec3::Zero()));
  probe.begin(kPeriod);
  probe.end();
  probe.set_contacts(contacts_on({4}, Vec3(0.01, 0.06, 0), Vec3::UnitX()));
  probe.set_pose(pose_at(Vec3(0, 0, 0.002), M_PI / 2));
  REQUIRE(probe.begin(kPeriod));
  std::vector<ContactRow> rows;
  probe.append_rows(0, ball.model, ball.state, kPeriod, 1.0, rows);
  REQUIRE(rows.size() == 1);
  CHECK((rows[0].normal - Vec3::UnitY()).norm() < 1e-12);
  const Vec3 moved = Vec3(-0.06, 0.01, 0.002) - Vec3(0.01, 0.06, 0);
  CHECK((rows[0].probe_velocity - moved / kPeriod).norm() < 1e-9);
  Vec3 tissue = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    tissue += rows[0].weights[static_cast<int>(k)] * ball.state.positions[rows[0].nodes[k]];
  }
  CHECK(rows[0].gap == Approx(Vec3::UnitY().dot(Vec3(0.01, 0.06, 0) - tissue)).epsilon(1e-12));
  CHECK(rows[0].friction == 0.3);
}

TEST_CASE("probe contacts: a depth nobody saw coming is undone gently, one that was at once") {
  // Oracle: the definition. A plate 2 cm below triangle 0, found there at once or after a search
  // that had it near; the tissue rests, then comes nearer at 0.3 m/s.
  Ball ball;
  const Vec3& tissue = ball.state.positions[ball.model.triangles[0][0]];
  for (const bool seen : {false, true}) {
    ProbeContacts probe(plate(0));
    probe.set_pose(pose_at(Vec3::Zero()));
    probe.begin(kPeriod);
    probe.end();
    std::vector<ContactRow> rows;
    if (seen) {
      probe.set_contacts(contacts_on({0}, tissue + 0.1 * Vec3::UnitZ(), Vec3::UnitZ()));
      probe.append_rows(0, ball.model, ball.state, kPeriod, 1.0, rows);
    }
    probe.set_contacts(contacts_on({0}, tissue - 0.02 * Vec3::UnitZ(), Vec3::UnitZ()));
    probe.begin(kPeriod);
    for (const double speed : {0.0, 0.3}) {
      for (Vec3& v : ball.state.velocities) v = Vec3(0, 0, speed);
      rows.clear();
      probe.append_rows(0, ball.model, ball.state, kPeriod, 1.0, rows);
      const double allowed = speed - kPeriod / ProbeContacts::kGentleRise * (speed + kGentleSpeed);
      if (seen) {
        CHECK(rows[0].gap < -0.01);
      } else {
        CHECK(rows[0].gap == Approx(allowed * kPeriod).epsilon(1e-12));
      }
    }
  }
}

TEST_CASE("probe contacts: sub-steps share the probe's way evenly") {
  // Oracle: the sum of the parts is the whole way.
  const Ball ball;
  ProbeContacts probe(plate(0));
  probe.set_pose(pose_at(Vec3::Zero()));
  probe.begin(kPeriod);
  probe.end();
  probe.set_contacts(contacts_on({0}, Vec3::Zero(), Vec3::UnitZ()));
  probe.set_pose(pose_at(Vec3(0.001, 0, 0)));
  probe.begin(kPeriod);
  Vec3 way = Vec3::Zero();
  for (int step = 1; step <= 4; ++step) {
    std::vector<ContactRow> rows;
    probe.append_rows(0, ball.model, ball.state, kPeriod / 4, step / 4.0, rows);
    way += rows[0].probe_velocity * kPeriod / 4;
  }
  CHECK((way - Vec3(0.001, 0, 0)).norm() < 1e-15);
}

TEST_CASE("probe contacts: a triangle touched again starts from its last impulses") {
  // Oracle: definition; triangles 2 and 5 stay, 3 is new, 7 is gone.
  const Ball ball;
  ProbeContacts probe(plate(0.1));
  probe.set_pose(pose_at(Vec3::Zero()));
  probe.set_contacts(contacts_on({2, 5, 7}, Vec3::Zero(), Vec3::UnitZ()));
  probe.begin(kPeriod);
  std::vector<ContactRow> rows;
  probe.append_rows(0, ball.model, ball.state, kPeriod, 1.0, rows);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].normal_impulse = 1.0 + double(i);
  CHECK(probe.take_rows(0, rows.data()) == 3);
  probe.end();
  CHECK(probe.touches(0));
  CHECK_FALSE(probe.touches(1));
  probe.set_contacts(contacts_on({2, 3, 5}, Vec3::Zero(), Vec3::UnitZ()));
  REQUIRE(probe.contacts().size() == 3);
  CHECK(probe.contacts()[0].normal_impulse == 1);
  CHECK(probe.contacts()[1].normal_impulse == 0);
  CHECK(probe.contacts()[2].normal_impulse == 2);
}

TEST_CASE("probe contacts: impulses add up over an advance, and the next begins without them") {
  // Oracle: by hand; impulses along −n and friction on the tissue, their negative on the probe.
  const Ball ball;
  ProbeContacts probe(plate(0.5));
  probe.set_pose(pose_at(Vec3::Zero()));
  probe.set_contacts(contacts_on({0, 4}, Vec3(0.01, 0, 0), Vec3::UnitZ()));
  probe.begin(kPeriod);
  for (const double fraction : {0.5, 1.0}) {
    std::vector<ContactRow> rows;
    probe.append_rows(0, ball.model, ball.state, kPeriod / 2, fraction, rows);
    rows[0].normal_impulse = 2e-3;
    rows[0].tangential_impulse = Vec3(0, 1e-3, 0);
    probe.take_rows(0, rows.data());
  }
  probe.end();
  CHECK((probe.impulse() - Vec3(0, -2e-3, 4e-3)).norm() < 1e-15);
  CHECK((probe.contacts()[0].pushed - Vec3(0, 0, 4e-3)).norm() < 1e-15);
  CHECK((probe.contacts()[0].dragged - Vec3(0, -2e-3, 0)).norm() < 1e-15);
  CHECK(probe.contacts()[1].pushed.isZero(0));
  probe.begin(kPeriod);
  CHECK(probe.impulse().isZero(0));
}

}  // namespace
}  // namespace palpate::deformation
