#include "studies/certify/subject.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "tests/studies/certify/subjects.h"

using namespace palpate;
using namespace palpate::testing;

TEST_CASE("certify subject: the place is where the scene's own motion first touches") {
  // Oracle: analytic, two balls touch where their centres are R + r apart. 0.2 mm: the ball is made
  // of flat triangles (sagitta below 0.3 % of R), and the finger comes in steps of 0.3 mm and less.
  const BallScene scene(kFingerFromAbove);
  const certify::Subject subject = certify::load_subject(scene.file(), kGoOn);
  CHECK((subject.place.pose.position - Vec3(0, 0, kBallRadius + kFingerRadius)).norm() < 2e-4);
  CHECK(subject.place.into.dot(-Vec3::UnitZ()) > 0.99);
  CHECK((subject.place.tip - Vec3(0, 0, kBallRadius)).norm() < 1e-3);
  CHECK(subject.device.start == subject.place.pose.position);
  CHECK(subject.scene.probes.size() == 1);
}

TEST_CASE("certify subject: a probe that nobody moves goes straight to the organ") {
  // Oracle: the same place, for it starts above it.
  const BallScene scene("topic: {start_m: [0, 0, 0.09]}");
  const certify::Subject subject = certify::load_subject(scene.file(), kGoOn);
  CHECK((subject.place.pose.position - Vec3(0, 0, kBallRadius + kFingerRadius)).norm() < 2e-4);
}

TEST_CASE("certify subject: an emulated device is the scene's own, without its hand") {
  // Oracle: the scene's text.
  const BallScene scene(
      "emulated: {start_m: [0, 0, 0.07], mass_kg: 0.3, transport_delay_s: 2e-3, hand: {push_n: "
      "[0, 0, -0.2]}}");
  const certify::Subject subject = certify::load_subject(scene.file(), kGoOn);
  CHECK(subject.device.mass == 0.3);
  CHECK(subject.device.transport_delay == 2e-3);
  CHECK(subject.device.hand.push.norm() == 0);
}
