#include "deformation/contact/condensed_contacts.h"

#include <catch2/catch.hpp>
#include <random>

#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

/// One node a contact, the plate's, each with an impulse.
struct Plate {
  OrganModel model = testing::ball_model(2);
  OrganState state = rest_state(model);
  SurfaceWalk surface{model};
  ProbeContacts probe{{"plate", scene::PlaneShape{}, 0, scene::ScriptedDevice{}}};

  /// @param impulse  of a contact, by its number; 0: it does not press
  template <class Impulse>
  void press(std::uint32_t count, const Impulse& impulse) {
    std::vector<Contact> contacts;
    for (std::uint32_t t = 0; t < count; ++t) {
      Contact contact;
      contact.triangle = t;
      contact.barycentric = Vec3(0.2, 0.3, 0.5);
      Vec3 place = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        place += contact.barycentric[k] *
                 state.positions[model.triangles[t][static_cast<std::size_t>(k)]];
      }
      contact.normal_P = place.normalized();
      contact.point_P = place + 1e-4 * t * contact.normal_P;
      contacts.push_back(contact);
    }
    touch(contacts, impulse);
  }
  template <class Impulse>
  void touch(const std::vector<Contact>& contacts, const Impulse& impulse) {
    probe.set_pose({});
    probe.set_contacts(contacts);
    probe.begin(kPeriod);
    std::vector<ContactRow> rows;
    probe.append_rows(0, surface, state, kPeriod, 1, rows);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].normal_impulse = impulse(i);
    probe.take_rows(0, kPeriod, rows);
    probe.end();
  }
  std::vector<CondensedContact> condense() const {
    return condense_contacts(probe, {&model}, {&state}, kPeriod);
  }
  static constexpr double kPeriod = 4e-3;
};

TEST_CASE("contact law: rows are the pressing contacts, strongest first, then the nearest") {
  // Oracle: by hand; gaps are 0.1 mm times the contact's number.
  Plate plate;
  plate.press(40, [](std::size_t i) { return i == 5 ? 1e-3 : i == 9 ? 2e-3 : 0; });
  const auto contacts = plate.condense();
  REQUIRE(contacts.size() == kMaxLawRows);
  CHECK(contacts[0].row.force.norm() == Approx(2e-3 / Plate::kPeriod));
  CHECK(contacts[1].row.force.norm() == Approx(1e-3 / Plate::kPeriod));
  CHECK(contacts[0].row.gap == 0);
  CHECK(contacts[2].row.gap == Approx(0).margin(1e-12));
  CHECK(contacts[3].row.gap == Approx(1e-4));
  CHECK(contacts.back().row.gap == Approx(15e-4));  // 0 … 15 without 5 and 9
}

TEST_CASE("contact law: of near contacts those that close first are told") {
  // Oracle: by hand; gaps are 0.1 mm times the contact's number, 3 mm that of number 30, whose
  // tissue comes by 4 mm in a period.
  Plate plate;
  plate.press(40, [](std::size_t) { return 0; });
  const auto tells_30 = [&] {
    return std::ranges::any_of(
        plate.condense(), [](const CondensedContact& c) { return c.row.gap == Approx(30e-4); });
  };
  CHECK_FALSE(tells_30());
  const Vec3 out = plate.probe.contacts()[30].normal_P;
  for (const std::uint32_t node : plate.model.triangles[30]) {
    plate.state.velocities[node] = 4e-3 / Plate::kPeriod * out;
  }
  CHECK(tells_30());
}

TEST_CASE("contact law: a place that triangles share is told once") {
  // Oracle: definition. A node that a plate is above is nearest on all triangles around it.
  Plate plate;
  const Vec3& node = plate.state.positions[0];
  std::vector<Contact> contacts;
  for (std::uint32_t t = 0; t < plate.model.triangles.size(); ++t) {
    const auto& nodes = plate.model.triangles[t];
    const auto at = std::ranges::find(nodes, 0u);
    if (at == nodes.end()) continue;
    Contact contact;
    contact.triangle = t;
    contact.barycentric = Vec3::Unit(at - nodes.begin());
    contact.normal_P = node.normalized();
    contact.point_P = node + 1e-4 * contact.normal_P;
    contacts.push_back(contact);
  }
  REQUIRE(contacts.size() >= 5);
  plate.touch(contacts, [](std::size_t) { return 0; });
  CHECK(plate.condense().size() == 1);
}

TEST_CASE(
    "contact law: more pressing contacts than rows are taken together, force and place kept") {
  // Oracle: sums over the contacts. The place of a sum of forces that are not parallel is not one
  // point: torque to 2 % of force times radius.
  Plate plate;
  plate.press(90, [](std::size_t i) { return 1e-3 * (1 + double(i % 7)); });
  const auto contacts = plate.condense();
  CHECK(contacts.size() <= kMaxLawRows);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero(), expected = Vec3::Zero(), turn = Vec3::Zero();
  for (const CondensedContact& c : contacts) {
    double weight = 0;
    for (const auto& [node, share] : c.weights) weight += share;
    CHECK(weight == Approx(1));
    force += c.row.force;
    torque += c.row.point_P.cross(c.row.force);
  }
  for (const CarriedContact& c : plate.probe.contacts()) {
    expected += c.pushed / Plate::kPeriod;
    turn += c.point_P.cross(c.pushed) / Plate::kPeriod;
  }
  CHECK((force - expected).norm() < 1e-12 * expected.norm());
  CHECK((torque - turn).norm() < 0.02 * expected.norm() * testing::kBallRadius);
}

TEST_CASE("contact law: neighbours are taken together about places far from each other") {
  // Oracle: the plain search. The strongest is the first place, then always the contact furthest
  // from all places; a contact belongs to the first of the places nearest to it.
  Plate plate;
  plate.press(250, [](std::size_t i) { return 1e-3 * (1 + double((37 * i) % 251)); });
  std::vector<CarriedContact> pressing = plate.probe.contacts();
  std::ranges::sort(pressing, std::greater{}, [](const auto& c) { return c.pushed.norm(); });
  const auto distance = [](const CarriedContact& a, const CarriedContact& b) {
    return (a.point_P - b.point_P).norm();
  };
  std::vector<CarriedContact> places{pressing.front()};
  const auto nearest = [&](const CarriedContact& c) {
    return std::ranges::min_element(places, {}, [&](const auto& p) { return distance(c, p); });
  };
  while (places.size() < kMaxLawRows) {
    const auto apart = [&](const CarriedContact& c) { return distance(c, *nearest(c)); };
    places.push_back(*std::ranges::max_element(pressing, {}, apart));
  }
  std::vector<Vec3> expected(places.size(), Vec3::Zero());
  for (const CarriedContact& c : pressing) {
    expected[static_cast<std::size_t>(nearest(c) - places.begin())] += c.pushed / Plate::kPeriod;
  }
  const auto contacts = plate.condense();
  REQUIRE(contacts.size() == places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    CHECK((contacts[i].row.force - expected[i]).norm() < 1e-12 * expected[i].norm());
  }
}

TEST_CASE("contact law: a round probe's normal turns over nodes and edges, not over a face") {
  // Oracle: geometry. A ball over the middle of a triangle, of an edge, and over a node, 0.1 mm
  // deep: the row there, which is the deepest, has the ball's radius or none.
  const OrganModel model = testing::ball_model(2);
  const OrganState state = rest_state(model);
  const geometry::Triangle& triangle = model.triangles[7];
  const double radius = 2e-3;
  for (const Vec3& at : {Vec3(0.3, 0.3, 0.4), Vec3(0.5, 0.5, 0), Vec3(1, 0, 0)}) {
    SurfaceWalk surface(model);
    ProbeContacts probe{{"ball", scene::SphereShape{radius}, 0, scene::ScriptedDevice{}}};
    Vec3 place = Vec3::Zero();
    for (int k = 0; k < 3; ++k) place += at[k] * state.positions[triangle[std::size_t(k)]];
    const Vec3 normal = (state.positions[triangle[1]] - state.positions[triangle[0]])
                            .cross(state.positions[triangle[2]] - state.positions[triangle[0]])
                            .normalized();
    const bool on_face = at.minCoeff() > 0;
    const Vec3 out = on_face ? normal : place.normalized();
    probe.set_pose({place + (radius - 1e-4) * out, Quat::Identity()});
    Contact seed;
    seed.triangle = 7;
    seed.normal_P = out;
    probe.set_contacts(std::vector{seed});
    probe.begin(Plate::kPeriod);
    std::vector<ContactRow> rows;
    probe.append_rows(0, surface, state, Plate::kPeriod, 1, rows);
    for (ContactRow& row : rows) row.normal_impulse = row.gap < 0 ? 1e-4 : 0;
    probe.take_rows(0, Plate::kPeriod, rows);
    probe.end();
    const auto contacts = condense_contacts(probe, {&model}, {&state}, Plate::kPeriod);
    REQUIRE_FALSE(contacts.empty());
    CHECK(contacts.front().row.radius == (on_face ? 0 : radius));
  }
}

TEST_CASE("contact law: what is on fixed nodes yields as the block under it does") {
  // Oracle: by hand, the square of the share of fixed nodes over the block's stiffness.
  Plate plate;
  plate.press(3, [](std::size_t i) { return i == 0 ? 2e-3 : i == 1 ? 1e-3 : 0; });
  REQUIRE(plate.condense().size() == 3);
  for (const std::uint32_t node : plate.model.triangles[0]) plate.model.inverse_masses[node] = 0;
  plate.model.youngs_modulus = 3e3;
  const auto contacts = plate.condense();
  REQUIRE(contacts.size() == 3);
  const auto& at = plate.model.rest_positions;
  const auto& fixed = plate.model.triangles[0];
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& [a, b, c] = plate.model.triangles[i];
    const double area = (at[b] - at[a]).cross(at[c] - at[a]).norm() / 2;
    double share = 0;
    for (const auto& [node, weight] : contacts[i].weights) {
      if (std::ranges::find(fixed, node) != fixed.end()) share += weight;
    }
    CHECK((share == Approx(1)) == (i == 0));
    CHECK(contacts[i].fixed_yielding == Approx(share * share / (3e3 * std::sqrt(area))));
  }
}

TEST_CASE("contact law: where pushes cancel each other their friction makes no row pull") {
  // Oracle: definition of a row, and the sum of the forces. Pushes every which way, one by one and
  // taken together, with friction across each of nearly its size.
  const std::uint32_t count = GENERATE(16u, 90u);
  Plate plate;
  plate.press(count, [](std::size_t) { return 0; });
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto direction = [&] {
    return Vec3(number(random), number(random), number(random)).normalized();
  };
  for (const double fraction : {0.5, 1.0}) {
    std::vector<ContactRow> rows;
    plate.probe.append_rows(0, plate.surface, plate.state, Plate::kPeriod / 2, fraction, rows);
    for (ContactRow& row : rows) {
      row.normal = direction();
      row.normal_impulse = 1e-3;
      row.tangential_impulse = 0.9e-3 * row.normal.cross(direction()).normalized();
    }
    plate.probe.take_rows(0, Plate::kPeriod / 2, rows);
  }
  Vec3 sum = Vec3::Zero();
  const auto contacts = plate.condense();
  REQUIRE(contacts.size() == kMaxLawRows);
  for (const CondensedContact& c : contacts) {
    CHECK(c.row.normal.norm() == Approx(1));
    CHECK(c.row.normal.dot(c.row.force) >= 0);
    sum += c.row.force;
  }
  CHECK((sum - plate.probe.impulse() / Plate::kPeriod).norm() < 1e-12);
}

}  // namespace
}  // namespace palpate::deformation
