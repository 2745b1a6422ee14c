#include "deformation/contact/probe_contacts.h"

#include <catch2/catch.hpp>

#include "tests/deformation/contact/touched_ball.h"

namespace palpate::deformation {
namespace {

using testing::contacts_on, testing::kPeriod, testing::plate, testing::pose_at, testing::Tip,
    testing::TouchedBall;

TEST_CASE("probe contacts: a contact moves rigidly with its probe") {
  // Oracle: rigid motion by hand; a quarter turn takes +x to +y.
  TouchedBall ball;
  ProbeContacts probe(plate(0.3));
  probe.set_pose(pose_at(Vec3::Zero()));
  probe.begin(kPeriod);
  probe.end();
  probe.set_contacts(contacts_on({4}, Vec3(0.01, 0.06, 0), Vec3::UnitX()));
  probe.set_pose(pose_at(Vec3(0, 0, 0.002), M_PI / 2));
  REQUIRE(probe.begin(kPeriod));
  std::vector<ContactRow> rows;
  probe.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
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

TEST_CASE("probe contacts: sub-steps share the probe's way evenly") {
  // Oracle: the sum of the parts is the whole way.
  TouchedBall ball;
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
    probe.append_rows(0, ball.surface, ball.state, kPeriod / 4, step / 4.0, rows);
    way += rows[0].probe_velocity * kPeriod / 4;
  }
  CHECK((way - Vec3(0.001, 0, 0)).norm() < 1e-15);
}

TEST_CASE("probe contacts: a triangle touched again starts from its last forces") {
  // Oracle: definition; triangles 2 and 5 stay, 3 is new, 7 is gone.
  TouchedBall ball;
  ProbeContacts probe(plate(0.1));
  probe.set_pose(pose_at(Vec3::Zero()));
  probe.set_contacts(contacts_on({2, 5, 7}, Vec3::Zero(), Vec3::UnitZ()));
  probe.begin(kPeriod);
  std::vector<ContactRow> rows;
  probe.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].normal_impulse = 1.0 + double(i);
  CHECK(probe.take_rows(0, kPeriod, rows) == 3);
  probe.end();
  CHECK(probe.touches(0));
  CHECK_FALSE(probe.touches(1));
  probe.set_contacts(contacts_on({2, 3, 5}, Vec3::Zero(), Vec3::UnitZ()));
  REQUIRE(probe.contacts().size() == 3);
  rows.clear();
  probe.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
  CHECK(rows[0].normal_impulse == Approx(1));
  CHECK(rows[1].normal_impulse == 0);
  CHECK(rows[2].normal_impulse == Approx(2));
}

TEST_CASE("probe contacts: a shorter step starts from as large a force, not as large an impulse") {
  // Oracle: impulse = force times time.
  TouchedBall ball;
  ProbeContacts probe(plate(0.1));
  probe.set_pose(pose_at(Vec3::Zero()));
  probe.set_contacts(contacts_on({2}, Vec3::Zero(), Vec3::UnitZ()));
  probe.begin(kPeriod);
  std::vector<ContactRow> rows;
  probe.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
  rows[0].normal_impulse = 8;
  rows[0].tangential_impulse = Vec3(0.4, 0, 0);
  probe.take_rows(0, kPeriod, rows);
  rows.clear();
  probe.append_rows(0, ball.surface, ball.state, kPeriod / 4, 0.25, rows);
  CHECK(rows[0].normal_impulse == Approx(2));
  CHECK(rows[0].tangential_impulse.x() == Approx(0.1));
}

TEST_CASE("probe contacts: fixed tissue has no row, and drags as far as its cone lets it") {
  // Oracle: by hand. A plate that is 1 mm deep in it goes 2 mm, then 10 mm, along it.
  TouchedBall ball;
  const geometry::Triangle& nodes = ball.model.triangles[2];
  ball.model.youngs_modulus = 5e3;
  ball.model.inverse_masses[nodes[0]] = ball.model.inverse_masses[nodes[1]] = 0;
  const auto& at = ball.state.positions;
  const Vec3 middle = (at[nodes[0]] + at[nodes[1]]) / 2;
  const double stiffness = fixed_stiffness(ball.model, 2);
  CHECK(stiffness == Approx(5e3 * std::sqrt(geometry::area_vector(at, nodes).norm())));
  ProbeContacts probe(plate(3));
  probe.set_pose(pose_at(Vec3::Zero()));
  auto contacts = contacts_on({2}, middle - 1e-3 * Vec3::UnitZ(), Vec3::UnitZ());
  contacts[0].barycentric = Vec3(0.5, 0.5, 0);
  probe.set_contacts(contacts);
  double along = 0;
  for (const double way : {2e-3, 10e-3}) {
    along += way;
    probe.set_pose(pose_at(Vec3(along, 0, 0)));
    probe.begin(kPeriod);
    std::vector<ContactRow> rows;
    probe.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
    CHECK(rows.empty());
    probe.take_rows(0, kPeriod, rows);
    probe.end();
    const Vec3 force(-stiffness * std::min(along, 3e-3), 0, 1e-3 * stiffness);
    CHECK((probe.impulse() / kPeriod - force).norm() < 1e-9 * force.norm());
  }
}

TEST_CASE("probe contacts: several corners of a sharp tool press one fixed triangle as one does") {
  // Oracle: by hand, shares d/Σd of the block's stiffness: equal depths give what one of them
  // gives.
  TouchedBall ball;
  const geometry::Triangle& nodes = ball.model.triangles[2];
  ball.model.youngs_modulus = 5e3;
  for (const std::uint32_t node : nodes) ball.model.inverse_masses[node] = 0;
  const auto& at = ball.state.positions;
  const double stiffness = fixed_stiffness(ball.model, 2);
  const auto force_of = [&](const std::vector<double>& depths) {
    ProbeContacts box({"box", scene::BoxShape{Vec3::Constant(0.01)}, 0, scene::ScriptedDevice{}});
    box.set_pose(pose_at(Vec3::Zero()));
    std::vector<Contact> contacts;
    for (std::size_t i = 0; i < depths.size(); ++i) {
      const Vec3 weights = Vec3::Constant(0.1) + 0.7 * Vec3::Unit(static_cast<int>(i % 3));
      Vec3 place = Vec3::Zero();
      for (int k = 0; k < 3; ++k) place += weights[k] * at[nodes[static_cast<std::size_t>(k)]];
      contacts.push_back(
          contacts_on({2}, place - depths[i] * Vec3::UnitZ(), Vec3::UnitZ()).front());
      contacts.back().barycentric = weights;
    }
    box.set_contacts(contacts);
    box.begin(kPeriod);
    std::vector<ContactRow> rows;
    box.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
    REQUIRE(rows.empty());
    box.take_rows(0, kPeriod, rows);
    return box.impulse().z() / kPeriod;
  };
  CHECK(force_of({1e-4}) == Approx(stiffness * 1e-4));
  CHECK(force_of({1e-4, -1e-3}) == Approx(stiffness * 1e-4));
  CHECK(force_of({1e-4, 1e-4, 1e-4}) == Approx(stiffness * 1e-4 * std::pow(3, 0.25)));
  CHECK(force_of({1e-4, 1e-4, 2e-4}) ==
        Approx(stiffness * 1e-4 * std::pow(18, 0.25)).epsilon(1e-3));
  double before = 0;
  for (double depth = 5e-5; depth < 2e-3; depth *= 1.3) {
    const double force = force_of({1e-3, depth, 2e-4});
    CHECK(force > before);
    before = force;
  }

  // Where a node can move what is fixed gives way so much more in each row, but no more than as an
  // equal part of it.
  ball.model.inverse_masses[nodes[2]] = 1;
  ProbeContacts box({"box", scene::BoxShape{Vec3::Constant(0.01)}, 0, scene::ScriptedDevice{}});
  box.set_pose(pose_at(Vec3::Zero()));
  const Vec3 weights = Vec3::Constant(1.0 / 3);
  const Vec3 place = (at[nodes[0]] + at[nodes[1]] + at[nodes[2]]) / 3;
  std::vector<Contact> contacts;
  for (const double depth : {1e-4, 3e-4}) {
    contacts.push_back(contacts_on({2}, place - depth * Vec3::UnitZ(), Vec3::UnitZ()).front());
    contacts.back().barycentric = weights;
  }
  box.set_contacts(contacts);
  box.begin(kPeriod);
  std::vector<ContactRow> rows;
  box.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
  REQUIRE(rows.size() == 2);
  const double yielding = fixed_yielding(ball.model, 2, weights);
  CHECK(rows[0].yielding == Approx(yielding / 0.5));
  CHECK(rows[1].yielding == Approx(yielding / std::pow(81.0 / 82, 0.75)));
}

TEST_CASE("probe contacts: a core that touches a triangle as it first sees it has no place there") {
  // Oracle: a place on a triangle, whose weights sum to one. A micrometre above a node, where a
  // direction would be rounding, all triangles but one are new.
  Tip tip;
  tip.organ.model.youngs_modulus = 5e3;
  for (const bool fixed : {false, true}) {
    if (fixed) tip.organ.model.inverse_masses.assign(tip.organ.model.node_count(), 0);
    tip.go(1e-6, 1e-6);
    CHECK(tip.probe.contacts().size() > 3);
    for (const CarriedContact& contact : tip.probe.contacts()) {
      if (contact.row == CarriedContact::kNoRow && !contact.on_fixed) continue;
      CHECK(contact.barycentric.sum() == Approx(1));
    }
  }
}

TEST_CASE("probe contacts: of several on a triangle each starts from what was at its own node") {
  // Oracle: definition; of three nodes of triangle 4 the first is gone, two come in other order.
  TouchedBall ball;
  ProbeContacts probe(plate(0.1));
  probe.set_pose(pose_at(Vec3::Zero()));
  const auto at_nodes = [](std::vector<int> corners) {
    auto contacts =
        contacts_on(std::vector<std::uint32_t>(corners.size(), 4), Vec3::Zero(), Vec3::UnitZ());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      contacts[i].barycentric = Vec3::Unit(corners[i]);
    }
    return contacts;
  };
  probe.set_contacts(at_nodes({0, 1, 2}));
  probe.begin(kPeriod);
  std::vector<ContactRow> rows;
  probe.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].normal_impulse = 1.0 + double(i);
  probe.take_rows(0, kPeriod, rows);
  probe.set_contacts(at_nodes({2, 1}));
  rows.clear();
  probe.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].normal_impulse == Approx(3));
  CHECK(rows[1].normal_impulse == Approx(2));
}

TEST_CASE("probe contacts: impulses add up over an advance, and the next begins without them") {
  // Oracle: by hand; impulses along −n and friction on the tissue, their negative on the probe.
  TouchedBall ball;
  ProbeContacts probe(plate(0.5));
  probe.set_pose(pose_at(Vec3::Zero()));
  probe.set_contacts(contacts_on({0, 4}, Vec3(0.01, 0, 0), Vec3::UnitZ()));
  probe.begin(kPeriod);
  for (const double fraction : {0.5, 1.0}) {
    std::vector<ContactRow> rows;
    probe.append_rows(0, ball.surface, ball.state, kPeriod / 2, fraction, rows);
    rows[0].normal_impulse = 2e-3;
    rows[0].tangential_impulse = Vec3(0, 1e-3, 0);
    probe.take_rows(0, kPeriod / 2, rows);
  }
  probe.end();
  CHECK((probe.impulse() - Vec3(0, -2e-3, 4e-3)).norm() < 1e-15);
  CHECK((probe.contacts()[0].pushed - Vec3(0, 0, 4e-3)).norm() < 1e-15);
  CHECK((probe.contacts()[0].dragged - Vec3(0, -2e-3, 0)).norm() < 1e-15);
  CHECK(probe.contacts()[1].pushed.isZero(0));
  probe.begin(kPeriod);
  CHECK(probe.impulse().isZero(0));
}

TEST_CASE(
    "probe contacts: a round probe has rows on all it touches, not on what it sees from behind") {
  // Oracle: brute force over all triangles; the search told of one alone.
  constexpr double kHeight = 0.75 * Tip::kRadius;
  Tip tip;
  tip.go(kHeight, kHeight);
  std::size_t touched = 0;
  for (std::uint32_t t = 0; t < tip.organ.model.triangles.size(); ++t) {
    const Vec3 c = tip.above(kHeight);
    const NearTriangle near = tip.organ.surface.triangle_near(t, c, c, tip.organ.state.positions);
    touched += near.pair.distance <= Tip::kRadius + ProbeContacts::kTouched && near.facing > 0;
  }
  CHECK(touched > 3);
  CHECK(tip.rows.size() == touched);
  for (const ContactRow& row : tip.rows) {
    CHECK(row.gap >= kHeight - Tip::kRadius - 1e-12);
    CHECK(row.gap <= ProbeContacts::kTouched);
    CHECK(row.normal.z() > 0.9);
  }
}

}  // namespace
}  // namespace palpate::deformation
