// Tissue that a round probe comes over within one step.
#include <catch2/catch.hpp>
#include <limits>

#include "deformation/contact/probe_contacts.h"
#include "tests/deformation/contact/touched_ball.h"

namespace palpate::deformation {
namespace {

using testing::contacts_on, testing::kBallRadius, testing::kPeriod, testing::pose_at,
    testing::ball_model, testing::TouchedBall;

/// Half as wide as the organ below it, given the contact of one triangle on top.
struct Wide {
  static constexpr double kRadius = kBallRadius / 2;
  TouchedBall organ{ball_model(3)};
  std::vector<ProbeContacts> probes;
  std::vector<ContactRow> rows;
  Vec3 centre = Vec3::Zero();  ///< at the step's end

  Wide() {
    probes.emplace_back(
        scene::Probe{"wide", scene::SphereShape{kRadius}, 0, scene::ScriptedDevice{}});
  }

  /// Straight down on the top, from so far to so deep.
  void go(double from, double to) {
    const auto above = [](double gap) { return Vec3(0, 0, kBallRadius + kRadius + gap); };
    const Vec3 tip(0, 0, -kRadius);
    std::uint32_t top = 0;
    const auto height = [&](std::uint32_t t) {
      double sum = 0;
      for (const auto node : organ.model.triangles[t]) sum += organ.state.positions[node].z();
      return sum;
    };
    for (std::uint32_t t = 0; t < organ.model.triangles.size(); ++t) {
      if (height(t) > height(top)) top = t;
    }
    ProbeContacts& probe = probes[0];
    probe.set_pose(pose_at(above(from)));
    probe.begin(kPeriod);
    probe.end();
    probe.set_contacts(contacts_on({top}, tip, Vec3::UnitZ()));
    probe.set_pose(pose_at(above(-to)));
    centre = above(-to);
    probe.begin(kPeriod);
    rows.clear();
    probe.append_rows(0, organ.surface, organ.state, kPeriod, 1.0, rows);
  }
  Missed missed(std::span<const Vec3> end) {
    return ProbeContacts::hold_missed(probes, 0, organ.surface, organ.state.positions, end, kPeriod,
                                      1.0, rows);
  }
  /// Of each triangle seen by the centre, how deep its nearest place is, by all triangles.
  std::vector<NearTriangle> swallowed(std::span<const Vec3> end) const {
    std::vector<NearTriangle> deep;
    for (std::uint32_t t = 0; t < organ.model.triangles.size(); ++t) {
      const NearTriangle near = organ.surface.triangle_near(t, centre, centre, end);
      if (near.facing > 0 && near.pair.distance < kRadius) deep.push_back(near);
    }
    return deep;
  }
};

}  // namespace

TEST_CASE("probe contacts: what a ball comes over within a step gets rows that keep it out") {
  // Oracle: brute force over all triangles for what is in the ball at the end, and geometry for the
  // rows: each starts with the way there was from the tissue to the ball along its normal, and
  // moves with the ball.
  Wide wide;
  const double from = 2e-3, to = 8e-3;
  wide.go(from, to);
  const std::size_t had = wide.rows.size();
  const auto& rest = wide.organ.state.positions;
  const auto deep = wide.swallowed(rest);
  REQUIRE(deep.size() > 2 * had);
  REQUIRE(wide.missed(rest) == Missed::kDepth);
  for (const NearTriangle& near : deep) {
    CHECK(std::ranges::any_of(wide.rows, [&](const ContactRow& row) {
      return (at_tissue(row, rest) - near.pair.on_triangle.point).norm() < 1e-6;
    }));
  }
  CHECK(wide.rows.size() <= had + deep.size());
  const Vec3 begin = wide.centre + Vec3(0, 0, from + to);
  for (std::size_t r = had; r < wide.rows.size(); ++r) {
    const ContactRow& row = wide.rows[r];
    const Vec3 x = at_tissue(row, rest);
    CHECK((row.normal - (wide.centre - x).normalized()).norm() < 1e-9);
    CHECK(row.gap == Approx((begin - x).dot(row.normal) - Wide::kRadius).margin(1e-12));
    CHECK(row.probe_velocity.z() == Approx(-(from + to) / kPeriod));
    CHECK(row.normal_impulse == 0);
  }
  // What stays deep though it has a row gets no other, and is told; tissue that went along is not
  // in it.
  const std::size_t has = wide.rows.size();
  CHECK(wide.missed(rest) == Missed::kDeeper);
  auto gone = rest;
  for (Vec3& x : gone) x.z() -= from + to;
  CHECK(wide.missed(gone) == Missed::kNothing);
  CHECK(wide.rows.size() == has);
}

TEST_CASE("probe contacts: tissue that is flung into a resting ball from elsewhere gets rows") {
  // Oracle: brute force over all triangles. The ball rests on top; a node of the bottom is flung
  // beside its centre, in two steps, the second no longer than what is ordinary.
  Wide wide;
  wide.go(0, 1e-6);
  auto& start = wide.organ.state.positions;
  const auto bottom = std::ranges::min_element(start, {}, [](const Vec3& x) { return x.z(); });
  auto end = start;
  Vec3& flung = end[static_cast<std::size_t>(bottom - start.begin())];
  const auto holds_all_in_it = [&] {
    const auto deep = wide.swallowed(end);
    REQUIRE(!deep.empty());
    REQUIRE(wide.missed(end) == Missed::kDepth);
    for (const NearTriangle& near : deep) {
      CHECK(std::ranges::any_of(wide.rows, [&](const ContactRow& row) {
        return (at_tissue(row, end) - near.pair.on_triangle.point).norm() < 1e-6;
      }));
    }
  };
  flung = wide.centre + Vec3(Wide::kRadius - 2e-4, 0, 0);
  holds_all_in_it();
  wide.probes[0].take_rows(0, kPeriod, wide.rows);
  start = end;
  wide.rows.clear();
  wide.probes[0].append_rows(0, wide.organ.surface, wide.organ.state, kPeriod, 1.0, wide.rows);
  flung.x() -= 3e-4;
  holds_all_in_it();
}

TEST_CASE("probe contacts: tissue that goes out gently is told of where it comes deeper") {
  // Oracle: the definition. A ball that was not seen coming is 3 mm deep; tissue that stays is not
  // told of, tissue that comes up by 1 mm is, in a step and by a change of mesh; where the ball was
  // seen coming the step after a change holds it.
  for (const bool seen_coming : {false, true}) {
    CAPTURE(seen_coming);
    Wide wide;
    seen_coming ? wide.go(0, 1e-6) : wide.go(-3e-3, 3e-3);
    ProbeContacts& probe = wide.probes[0];
    REQUIRE(probe.is_gentle(0) != seen_coming);
    const auto& rest = wide.organ.state.positions;
    CHECK(wide.missed(rest) == Missed::kNothing);
    auto risen = rest;
    for (Vec3& x : risen) x.z() += 1e-3;
    Missed missed = Missed::kDepth;
    for (int tries = 0; missed == Missed::kDepth && tries < 4; ++tries) missed = wide.missed(risen);
    CHECK(missed == Missed::kDeeper);
    const OrganModel& model = wide.organ.model;
    const geometry::SurfaceTransfer same(model.rest_positions, model.triangles,
                                         model.rest_positions, model.triangles);
    std::vector<CoreLine> cores;
    probe.end();
    for (const auto& after : {rest, risen}) {
      probe.begin_change(0, wide.organ.surface, rest, cores);
      CHECK(probe.change_surface(0, same, wide.organ.surface, after) ==
            (!seen_coming && after == risen));
    }
  }
}

TEST_CASE("probe contacts: a place that came deep beside a triangle's row has a row of its own") {
  // Oracle: geometry. The tissue at the end is turned about the first row's place, which stays
  // where it is: another place of that triangle comes up into the ball.
  Wide wide;
  wide.go(0, 1e-6);
  REQUIRE(!wide.rows.empty());
  const auto& rest = wide.organ.state.positions;
  const ContactRow first = wide.rows[0];
  const Vec3 pivot = at_tissue(first, rest);
  auto end = rest;
  const Quat turn(Eigen::AngleAxisd(0.5, Vec3::UnitX()));
  for (Vec3& x : end) x = pivot + turn * (x - pivot);
  const std::size_t had = wide.rows.size();
  REQUIRE(wide.missed(end) == Missed::kDepth);
  const auto is_of_first = [&](const ContactRow& row) { return row.nodes == first.nodes; };
  CHECK(std::count_if(wide.rows.begin(), wide.rows.end(), is_of_first) == 2);
  CHECK(wide.rows.size() > had);
  // After the step there is one contact to a triangle, which has done what both did.
  for (ContactRow& row : wide.rows) row.normal_impulse = is_of_first(row) ? 1 : 0;
  CHECK(wide.probes[0].take_rows(0, kPeriod, wide.rows) == wide.rows.size());
  double force = 0, triangles = 0;
  for (const CarriedContact& contact : wide.probes[0].contacts()) {
    if (wide.organ.model.triangles[contact.triangle] != first.nodes) continue;
    force += contact.normal_force;
    ++triangles;
  }
  CHECK(triangles == 1);
  CHECK(force == Approx(2 / kPeriod));
  CHECK(wide.probes[0].impulse().norm() == Approx(2).epsilon(0.2));
}

TEST_CASE(
    "probe contacts: a step in which nothing goes further than a step may leave looks at nothing") {
  // Oracle: the bound itself: a ball that lies in tissue by other means keeps its rows.
  Wide wide;
  wide.go(-9.99e-3, 10e-3);
  const std::size_t had = wide.rows.size();
  CHECK(wide.missed(wide.organ.state.positions) == Missed::kNothing);
  CHECK(wide.rows.size() == had);
}

}  // namespace palpate::deformation
