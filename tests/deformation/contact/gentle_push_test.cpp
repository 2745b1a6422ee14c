#include "deformation/contact/gentle_push.h"

#include <catch2/catch.hpp>

#include "tests/deformation/contact/touched_ball.h"

namespace palpate::deformation {
namespace {

using testing::contacts_on, testing::kPeriod, testing::plate, testing::pose_at,
    testing::TouchedBall;

TEST_CASE("gentle push: a depth nobody saw coming is undone gently, one that was at once") {
  // Oracle: the definition. A plate 2 cm below triangle 0, found there at once or after a search
  // that had it near; the tissue comes nearer at 0.3 m/s for kEnd, then at 0.6, as what a
  // jump of the probe has thrown would: of that it is let come what is left of the first approach.
  TouchedBall ball;
  const Vec3& tissue = ball.state.positions[ball.model.triangles[0][0]];
  for (const bool seen : {false, true}) {
    ProbeContacts probe(plate(0));
    probe.set_pose(pose_at(Vec3::Zero()));
    probe.begin(kPeriod);
    probe.end();
    std::vector<ContactRow> rows;
    if (seen) {
      probe.set_contacts(contacts_on({0}, tissue + 0.1 * Vec3::UnitZ(), Vec3::UnitZ()));
      probe.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
    }
    probe.set_contacts(contacts_on({0}, tissue - 0.02 * Vec3::UnitZ(), Vec3::UnitZ()));
    probe.begin(kPeriod);
    double time = 0, most = 0;
    while (time < 2 * GentlePush::kEnd) {
      time += kPeriod;
      const bool early = time < GentlePush::kEnd;
      const double speed = early ? 0.3 : 0.6;
      for (Vec3& v : ball.state.velocities) v = Vec3(0, 0, speed);
      rows.clear();
      probe.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
      most = early ? std::max(most, speed) : most * (1 - kPeriod / GentlePush::kEnd);
      const double approach = std::min(speed, most);
      const double allowed = approach - kPeriod / GentlePush::kRise * (approach + kGentleSpeed);
      if (seen) {
        CHECK(rows[0].gap < -0.01);
      } else {
        CHECK(rows[0].gap == Approx(allowed * kPeriod).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("gentle push: where a probe moves on, tissue it is gentle to goes along") {
  // Oracle: the definition. A plate found 2 cm below triangle 0 goes on at 1 m/s into tissue that
  // rests, then away from it. Before, tissue came to the probe's speed within kRise, and a
  // ball of 8 mm sank 18 mm into a liver in a hundredth of a second.
  TouchedBall ball;
  const Vec3& tissue = ball.state.positions[ball.model.triangles[0][0]];
  for (const double inward : {1.0, -1.0}) {
    ProbeContacts probe(plate(0));
    probe.set_pose(pose_at(Vec3::Zero()));
    probe.begin(kPeriod);
    probe.end();
    probe.set_contacts(contacts_on({0}, tissue - 0.02 * Vec3::UnitZ(), Vec3::UnitZ()));
    probe.set_pose(pose_at(Vec3(0, 0, -inward * kPeriod)));
    probe.begin(kPeriod);
    std::vector<ContactRow> rows;
    probe.append_rows(0, ball.surface, ball.state, kPeriod, 1.0, rows);
    const double change = kPeriod / GentlePush::kRise;
    const double relative = inward > 0 ? 0 : inward;  // of tissue towards the plate [m/s]
    const double approach = std::max(relative, -kGentleSpeed);
    const double allowed = approach - change * (approach + kGentleSpeed);
    CHECK(rows[0].gap == Approx(allowed * kPeriod).epsilon(1e-9));
  }
}

}  // namespace
}  // namespace palpate::deformation
