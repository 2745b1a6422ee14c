#include "deformation/contact/probe_contacts.h"

#include <catch2/catch.hpp>

#include "modules/core/rotation_vector.h"
#include "tests/deformation/contact/touched_ball.h"

namespace palpate::deformation {
namespace {

using testing::contacts_on, testing::kPeriod, testing::plate, testing::pose_at,
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

/// A ball of 2 mm over the organ's highest node, given the contacts of some triangles about it.
struct Tip {
  static constexpr double kRadius = 2e-3;
  TouchedBall organ;
  ProbeContacts probe{{"tip", scene::SphereShape{kRadius}, 0, scene::ScriptedDevice{}}};
  std::uint32_t top = 0, one = 0;  ///< node, and a triangle around it
  std::vector<ContactRow> rows;

  Tip() {
    const auto& x = organ.state.positions;
    for (std::uint32_t i = 0; i < organ.model.surface_node_count; ++i) {
      if (x[i].z() > x[top].z()) top = i;
    }
    while (std::ranges::count(organ.model.triangles[one], top) == 0) ++one;
  }
  Vec3 above(double height) const { return organ.state.positions[top] + height * Vec3::UnitZ(); }
  /// From `from` to `to` over the top within a period, as it begins.
  void go(double from, double to) {
    probe.set_pose(pose_at(above(from)));
    probe.begin(kPeriod);
    probe.end();
    probe.set_contacts(contacts_on({one}, Vec3(0, 0, -kRadius), Vec3::UnitZ()));
    probe.set_pose(pose_at(above(to)));
    probe.begin(kPeriod);
    rows.clear();
    probe.append_rows(0, organ.surface, organ.state, kPeriod, 1.0, rows);
  }
  bool held(const std::vector<Vec3>& end) {
    return probe.hold_crossed(0, organ.surface, organ.state.positions, end, kPeriod, 1.0, rows);
  }
};

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

TEST_CASE("probe contacts: a core that went through the wall gets a row where it did") {
  // Oracle: analytic. Straight down through the top, tissue at rest; tissue that gives way as far
  // was not crossed.
  Tip tip;
  const double from = 4e-3, to = -3e-3;
  tip.go(from, to);
  const std::size_t seen = tip.rows.size();
  REQUIRE(tip.held(tip.organ.state.positions));
  CHECK(tip.rows.size() <= seen + 1);
  const auto row = std::ranges::find_if(tip.rows, [&](const ContactRow& r) {
    Vec3 tissue = Vec3::Zero();
    for (int k = 0; k < 3; ++k) tissue += r.weights[k] * tip.organ.state.positions[r.nodes[k]];
    return (tissue - tip.above(0)).norm() < 1e-6;
  });
  REQUIRE(row != tip.rows.end());
  CHECK(row->gap == Approx(row->normal.z() * from - Tip::kRadius).margin(1e-6));
  CHECK(row->probe_velocity.z() == Approx((to - from) / kPeriod));
  auto yielded = tip.organ.state.positions;
  for (Vec3& x : yielded) x.z() += to - from;
  CHECK_FALSE(tip.held(yielded));
}

TEST_CASE("probe contacts: a core that lies across the wall is held where its side would go in") {
  // Oracle: geometry: of a rod over the top, both ends stay beyond the ball; the first it meets is
  // the highest node, by an edge there. Held by nothing, brute force finds the core in the wall.
  Tip tip;
  scene::CapsuleShape rod{Tip::kRadius, 4 * testing::kBallRadius};
  tip.probe = ProbeContacts({"rod", rod, 0, scene::ScriptedDevice{}});
  const auto lay = [&](double height) {
    tip.probe.set_pose({tip.above(height), rotation_between(Vec3::UnitZ(), Vec3(1, 0.3, 0))});
  };
  const double from = 4e-3, to = -3e-3;
  lay(from);
  tip.probe.begin(kPeriod);
  tip.probe.end();
  tip.probe.set_contacts(contacts_on({tip.one}, Vec3(Tip::kRadius, 0, 0), -Vec3::UnitX()));
  lay(to);
  tip.probe.begin(kPeriod);
  tip.probe.append_rows(0, tip.organ.surface, tip.organ.state, kPeriod, 1.0, tip.rows);
  REQUIRE(tip.held(tip.organ.state.positions));
  const bool at_top = std::ranges::any_of(tip.rows, [&](const ContactRow& r) {
    Vec3 tissue = Vec3::Zero();
    for (int k = 0; k < 3; ++k) tissue += r.weights[k] * tip.organ.state.positions[r.nodes[k]];
    const double gap = r.normal.z() * from - Tip::kRadius;
    return (tissue - tip.above(0)).norm() < 1e-6 && std::abs(r.gap - gap) < 1e-6;
  });
  CHECK(at_top);
  auto yielded = tip.organ.state.positions;
  for (Vec3& x : yielded) x.z() += to - from;
  CHECK_FALSE(tip.held(yielded));
}

TEST_CASE("probe contacts: a wall that was watched is seen coming, whatever searches found") {
  // Oracle: the definition. A tip above the wall, a search that finds nothing, tissue that swings
  // past its middle, and a search that finds it deep: it is held as before, not let through.
  Tip tip;
  tip.go(4e-3, 4e-3);
  tip.probe.end();
  tip.probe.set_contacts({});
  const auto rest = tip.organ.state.positions;
  for (Vec3& x : tip.organ.state.positions) x.z() += 3.9e-3;
  tip.probe.set_contacts(contacts_on({tip.one}, Vec3(0, 0, -Tip::kRadius), Vec3::UnitZ()));
  tip.probe.begin(kPeriod);
  tip.rows.clear();
  tip.probe.append_rows(0, tip.organ.surface, tip.organ.state, kPeriod, 1.0, tip.rows);
  double deepest = 0;
  for (const ContactRow& row : tip.rows) deepest = std::min(deepest, row.gap);
  CHECK(deepest == Approx(0.1e-3 - Tip::kRadius).epsilon(1e-3));
  auto swung = tip.organ.state.positions;
  for (Vec3& x : swung) x.z() += 1e-3;
  CHECK(tip.held(swung));
}

TEST_CASE("probe contacts: a core that was never inside is held, however gently it is pushed out") {
  // Oracle: the definition. A tip that nobody saw coming, its middle outside or inside; tissue then
  // swings past it. Only a core on its way out may swing back in.
  for (const double height : {0.1e-3, -3e-3}) {
    Tip tip;
    const auto move = [&](double up) {
      for (Vec3& x : tip.organ.state.positions) x.z() += up;
    };
    const Vec3 at = tip.above(height);
    tip.probe.set_pose(pose_at(at));
    tip.probe.begin(kPeriod);
    tip.probe.end();
    tip.probe.set_contacts(contacts_on({tip.one}, -Tip::kRadius * Vec3::UnitZ(), Vec3::UnitZ()));
    tip.probe.begin(kPeriod);
    for (int step = 0; step < 2; ++step) {
      tip.rows.clear();
      tip.probe.append_rows(0, tip.organ.surface, tip.organ.state, kPeriod, 1.0, tip.rows);
      REQUIRE_FALSE(tip.rows.empty());
      if (step == 0 && height < 0) move(height - 0.1e-3);  // it comes out
    }
    auto swung = tip.organ.state.positions;
    for (Vec3& x : swung) x.z() += 1e-3;
    CHECK(tip.held(swung) == (height > 0));
  }
}

TEST_CASE("probe contacts: tissue a search found out of reach is watched while it is near") {
  // Oracle: analytic: an empty list, then straight down through the top. From far away the watch
  // begins with the way; there is none where nobody knows.
  constexpr double kLong = 0.1;  // in which it goes 60 mm and is no jump [s]
  for (const double height : {4e-3, 0.5 * ProbeContacts::kWatched, 2 * ProbeContacts::kWatched}) {
    Tip tip;
    tip.go(height, height);
    tip.probe.set_contacts({});
    const bool is_near = height < ProbeContacts::kWatched;
    CHECK(tip.probe.may_cross(0) == is_near);
    tip.probe.end();
    tip.probe.set_pose(pose_at(tip.above(-3e-3)));
    REQUIRE(tip.probe.begin(kLong));
    tip.rows.clear();
    const auto& x = tip.organ.state.positions;
    tip.probe.append_rows(0, tip.organ.surface, tip.organ.state, kLong, 1.0, tip.rows);
    CHECK(tip.rows.empty());
    CHECK(tip.probe.hold_crossed(0, tip.organ.surface, x, x, kLong, 1.0, tip.rows));
    CHECK(tip.rows.size() == 1);
    tip.probe.forget_contacts();
    CHECK_FALSE(tip.probe.may_cross(0));
  }
}

TEST_CASE("probe contacts: a probe that starts in a hurry is held at a wall no search told it of") {
  // Oracle: analytic: straight down through the top from twice kWatched above. A probe nobody
  // searched for, or one that lies in tissue, is not watched.
  constexpr double kLong = 0.1;  // [s]
  for (const bool searched : {true, false}) {
    for (const double height : {2 * ProbeContacts::kWatched, 0.5 * Tip::kRadius}) {
      Tip tip;
      tip.probe.set_pose(pose_at(tip.above(height)));
      tip.probe.begin(kLong);
      tip.probe.end();
      if (searched) tip.probe.set_contacts({});
      tip.probe.set_pose(pose_at(tip.above(-3e-3)));
      REQUIRE(tip.probe.begin(kLong));
      const auto& x = tip.organ.state.positions;
      tip.probe.append_rows(0, tip.organ.surface, tip.organ.state, kLong, 1.0, tip.rows);
      CHECK(tip.rows.empty());
      const bool held = searched && height > Tip::kRadius;
      CHECK(tip.probe.hold_crossed(0, tip.organ.surface, x, x, kLong, 1.0, tip.rows) == held);
      CHECK(tip.rows.size() == (held ? 1 : 0));
    }
  }
}

}  // namespace
}  // namespace palpate::deformation
