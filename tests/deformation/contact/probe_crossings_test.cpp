// Cores that go, or would go, through a wall.
#include <catch2/catch.hpp>

#include "modules/core/rotation_vector.h"
#include "tests/deformation/contact/touched_ball.h"

namespace palpate::deformation {
namespace {

using testing::contacts_on, testing::kPeriod, testing::pose_at, testing::Tip, testing::TouchedBall;

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

TEST_CASE("probe contacts: a wall that goes through a sharp tool where it has no row is held") {
  // Oracle: geometry. A cone and a box rest over the ball's top, with a row of a place beside it
  // alone; tissue comes up past the tip and into the face, by 3 mm, and the rows that it gets there
  // ask of it to stay where the tool is. Tissue that stays is not held.
  const scene::BoxShape box{Vec3(8e-3, 8e-3, 8e-3)};
  for (const scene::ProbeShape& shape :
       {scene::ProbeShape(scene::ConeShape{}), scene::ProbeShape(box)}) {
    Tip tip;
    const bool is_box = std::holds_alternative<scene::BoxShape>(shape);
    tip.probe = ProbeContacts({"tool", shape, 0, scene::ScriptedDevice{}});
    const Pose pose = pose_at(tip.above(is_box ? box.size.z() / 2 + 1e-4 : 1e-4));
    tip.probe.set_pose(pose);
    tip.probe.begin(kPeriod);
    tip.probe.end();
    tip.probe.set_contacts(contacts_on({tip.one}, pose.to_body(tip.above(1e-4)), Vec3::UnitX()));
    tip.probe.begin(kPeriod);
    tip.probe.append_rows(0, tip.organ.surface, tip.organ.state, kPeriod, 1.0, tip.rows);
    REQUIRE(tip.rows.size() == 1);
    const auto& start = tip.organ.state.positions;
    const auto held = [&](const std::vector<Vec3>& end) {
      return tip.probe.hold_pierced(0, tip.organ.surface, start, end, kPeriod, 1.0, tip.rows);
    };
    REQUIRE(tip.probe.may_miss(0));
    CHECK_FALSE(held(start));
    auto risen = start;
    for (Vec3& x : risen) x.z() += 3e-3;
    CHECK(held(risen));
    REQUIRE(tip.rows.size() > 1);
    for (const ContactRow& row : std::span(tip.rows).subspan(1)) {
      CHECK(row.normal.z() > 0.5);
      CHECK(row.gap > -1e-9);
      CHECK(row.gap < 2e-3);
      CHECK(row.probe_velocity.norm() == 0);
    }
  }
}

TEST_CASE("probe contacts: a wall that a step left across a core is put back off it") {
  // Oracle: the winding number all along the core. Tissue comes up past a rod that lies over the
  // top, and past a ball; taken as a last resort, no row having held it.
  for (const double length : {0.0, 4 * testing::kBallRadius}) {
    Tip tip;
    const Pose pose = tip.lay_across(length);
    auto& x = tip.organ.state.positions;
    const auto put_back = [&] {
      tip.probe.take_rows(0, kPeriod, tip.rows);
      return ProbeContacts::put_back_outside(std::span(&tip.probe, 1), 0, tip.organ.surface, x, 1);
    };
    const Vec3 half(length / 2 * pose.rotation._transformVector(Vec3::UnitZ()));
    const CoreLine core{pose.position - half, pose.position + half};
    const auto is_outside = [&] { return are_outside(std::span(&core, 1), tip.organ.model, x); };
    const auto before = x;
    REQUIRE_FALSE(put_back());  // nothing is wrong yet
    CHECK(x == before);
    for (Vec3& p : x) p.z() += 3e-3;
    REQUIRE_FALSE(is_outside());
    tip.probe.hold_crossed(0, tip.organ.surface, before, x, kPeriod, 1.0, tip.rows);
    CHECK(put_back());
    CHECK(is_outside());
    std::vector<CoreLine> kept;
    tip.probe.begin_change(0, tip.organ.surface, x, kept);
    CHECK(kept.size() == 1);
  }
}

TEST_CASE(
    "probe contacts: a core through a wall that is inside out is told, and left where it is") {
  // Oracle: the winding number is nowhere above 0 in an organ that is turned inside out.
  Tip tip;
  tip.lay_across(4 * testing::kBallRadius);
  auto& x = tip.organ.state.positions;
  for (Vec3& p : x) p = Vec3(-p.x(), p.y(), p.z() + 3e-3);
  const auto before = x;
  tip.probe.take_rows(0, kPeriod, tip.rows);
  CHECK(ProbeContacts::put_back_outside(std::span(&tip.probe, 1), 0, tip.organ.surface, x, 1));
  CHECK(x == before);
}

TEST_CASE("probe contacts: another fold that a new mesh brought near is watched for crossings") {
  // Oracle: geometry. Of two balls that share no node one is under a tip, the other comes down on
  // it from above after the mesh changed; no search told of that one.
  Tip tip;
  const OrganModel& ball = tip.organ.model;
  Body two = ball;
  const double up = 2 * ball.rest_positions[tip.top].z() + 4e-3;
  const auto count = static_cast<std::uint32_t>(ball.rest_positions.size());
  for (const Vec3& x : ball.rest_positions) two.rest_positions.push_back(x + up * Vec3::UnitZ());
  for (geometry::Triangle t : ball.triangles) {
    for (std::uint32_t& node : t) node += count;
    two.triangles.push_back(t);
  }
  two.inverse_masses.insert(two.inverse_masses.end(), ball.inverse_masses.begin(),
                            ball.inverse_masses.end());
  two.surface_node_count = 2 * count;
  SurfaceWalk surface(two);
  OrganState state;
  state.positions = two.rest_positions;
  state.velocities.assign(state.positions.size(), Vec3::Zero());
  tip.probe.set_pose(pose_at(tip.above(2e-3)));
  tip.probe.begin(kPeriod);
  tip.probe.end();
  tip.probe.set_contacts(contacts_on({tip.one}, Vec3(0, 0, -Tip::kRadius), Vec3::UnitZ()));
  tip.probe.begin(kPeriod);
  tip.probe.append_rows(0, surface, state, kPeriod, 1.0, tip.rows);
  auto end = state.positions;
  for (std::size_t i = count; i < end.size(); ++i) end[i].z() -= 3e-3;
  const auto held = [&] {
    return tip.probe.hold_crossed(0, surface, state.positions, end, kPeriod, 1.0, tip.rows);
  };
  CHECK_FALSE(held());  // nobody knows of it
  const geometry::SurfaceTransfer same(two.rest_positions, two.triangles, two.rest_positions,
                                       two.triangles);
  tip.probe.change_surface(0, same, surface, state.positions);
  CHECK(held());
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

TEST_CASE("probe contacts: a fold that swings nearer than the wall beside it is watched, too") {
  // Oracle: geometry: two balls, as one wall; the tip rests over the one, and the other comes from
  // above, faster than searches know tissue to be, and over it.
  Tip tip;
  const TouchedBall one;
  const auto count = static_cast<std::uint32_t>(one.model.rest_positions.size());
  OrganModel two = testing::ball_model(1);
  for (const auto& [a, b, c] : one.model.triangles) {
    two.triangles.push_back({a + count, b + count, c + count});
  }
  two.rest_positions.insert(two.rest_positions.end(), one.model.rest_positions.begin(),
                            one.model.rest_positions.end());
  two.inverse_masses.insert(two.inverse_masses.end(), one.model.inverse_masses.begin(),
                            one.model.inverse_masses.end());
  two.surface_node_count = 2 * count;
  SurfaceWalk surface(two);
  OrganState state = one.state;
  state.positions.resize(2 * count);
  const double rests = 2 * testing::kBallRadius + 2e-3;  // so high its middle lies over the tip [m]
  const auto lower_to = [&](double height) {
    for (std::uint32_t i = 0; i < count; ++i) {
      state.positions[count + i] = one.state.positions[i] + (rests + height) * Vec3::UnitZ();
    }
  };
  tip.probe.set_pose(pose_at(tip.above(6e-3)));
  for (const double height : {20e-3, 8e-3}) {
    tip.probe.begin(kPeriod);
    lower_to(height);
    tip.probe.set_contacts({});
    tip.rows.clear();
    tip.probe.append_rows(0, surface, state, kPeriod, 1.0, tip.rows);
    CHECK(tip.rows.empty());
    tip.probe.end();
  }
  const std::vector<Vec3> start = state.positions;
  lower_to(2e-3);
  CHECK(tip.probe.hold_crossed(0, surface, start, state.positions, kPeriod, 1.0, tip.rows));
}

}  // namespace
}  // namespace palpate::deformation
