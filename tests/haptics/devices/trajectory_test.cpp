#include "haptics/devices/trajectory.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "modules/core/rotation_vector.h"

using namespace palpate;
using namespace palpate::haptics;

namespace {

/// Irregular times, positions and rotations; every second quaternion with the other sign.
std::vector<TimedPose> random_samples(unsigned seed, double max_angle = 0.5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<TimedPose> samples;
  Quat rotation = Quat::Identity();
  double time = 3;
  for (int i = 0; i < 40; ++i) {
    time += 0.01 * (1.2 + unit(random));
    const Vec3 turn = max_angle / 2 * Vec3(unit(random), unit(random), unit(random));
    rotation = (rotation * rotation_from_vector(turn)).normalized();
    TimedPose sample{time, {0.01 * Vec3(unit(random), unit(random), unit(random)), rotation}};
    if (i % 2) sample.pose.rotation.coeffs() *= -1;
    samples.push_back(sample);
  }
  return samples;
}

double angle_between(const Quat& a, const Quat& b) {
  return vector_from_rotation(a.conjugate() * b).norm();
}

}  // namespace

TEST_CASE("trajectory: passes through every sample") {
  // Oracle: invariant. Tolerance: rounding of times (1e-16 relative) times speeds of ~10 m/s.
  const std::vector<TimedPose> samples = random_samples(1);
  const Trajectory trajectory(samples, false);
  for (const TimedPose& sample : samples) {
    const DeviceSample at = trajectory.at(sample.time - samples.front().time);
    CHECK((at.pose.position - sample.pose.position).norm() < 1e-14);
    CHECK(angle_between(at.pose.rotation, sample.pose.rotation) < 1e-13);
  }
  CHECK(trajectory.duration() == samples.back().time - samples.front().time);
}

TEST_CASE("trajectory: the twist is the derivative of the pose, and has no jumps") {
  // Oracle: central finite difference with step e; its error is e²/6 of the third derivative,
  // here below 1e-12/6 · 6·20 mm/(2 ms)³·2 ≈ 5e-6 m/s, alike for the rotation.
  const bool loop = GENERATE(false, true);
  const std::vector<TimedPose> samples = random_samples(2);
  const Trajectory trajectory(samples, loop);
  const double e = 1e-6;
  const double end = trajectory.duration() + 0.5;  // of the way back, which may take longer
  for (double t = 1.3e-4; t < 2 * end; t += 3.1e-4) {
    const DeviceSample before = trajectory.at(t - e), at = trajectory.at(t);
    const DeviceSample after = trajectory.at(t + e);
    const Vec3 velocity = (after.pose.position - before.pose.position) / (2 * e);
    const Vec3 turn =
        vector_from_rotation(after.pose.rotation * before.pose.rotation.conjugate()) / (2 * e);
    REQUIRE((velocity - at.twist.linear).norm() < 1e-4 * (1 + at.twist.linear.norm()));
    REQUIRE((turn - at.twist.angular).norm() < 2e-3 * (1 + at.twist.angular.norm()));
  }
  for (const TimedPose& sample : samples) {
    // C1 at the knots: within 2 ns the twist changes by acceleration · 2 ns only
    // (≤ 6·2·20 mm/(2 ms)² = 6e4 m/s² → 1.2e-4 m/s; rotation ≤ 6·2·0.5/(2 ms)² → 3e-3 rad/s).
    const double t = sample.time - samples.front().time;
    const Twist a = trajectory.at(t - 1e-9).twist, b = trajectory.at(t + 1e-9).twist;
    CHECK((a.linear - b.linear).norm() < 1.2e-4);
    CHECK((a.angular - b.angular).norm() < 3e-3);
  }
}

TEST_CASE("trajectory: between two samples no coordinate leaves their interval") {
  // Oracle: invariant of monotone interpolation (a press is never deepened); rounding 1e-16.
  const std::vector<TimedPose> samples = random_samples(3);
  const Trajectory trajectory(samples, false);
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const Vec3 a = samples[i].pose.position, b = samples[i + 1].pose.position;
    for (int step = 1; step < 50; ++step) {
      const double share = step / 50.0;
      const double t = (1 - share) * samples[i].time + share * samples[i + 1].time;
      const Vec3 p = trajectory.at(t - samples.front().time).pose.position;
      REQUIRE((p.array() >= a.cwiseMin(b).array() - 1e-16).all());
      REQUIRE((p.array() <= a.cwiseMax(b).array() + 1e-16).all());
    }
  }
}

TEST_CASE("trajectory: uniform motion and uniform rotation are reproduced exactly inside") {
  // Oracle: analytic. The first and last interval are left out: they start and end at rest.
  const Vec3 velocity(0.02, -0.01, 0.03), turn(0.5, 1, -0.7);
  std::vector<TimedPose> samples;
  for (const double t : {0.0, 0.1, 0.17, 0.3, 0.31, 0.5}) {
    samples.push_back({t, {t * velocity, rotation_from_vector(t * turn)}});
  }
  const Trajectory trajectory(samples, false);
  for (double t = 0.1; t < 0.31; t += 0.007) {
    const DeviceSample at = trajectory.at(t);
    CHECK((at.pose.position - t * velocity).norm() < 1e-15);
    CHECK((at.twist.linear - velocity).norm() < 1e-12);
    CHECK(angle_between(at.pose.rotation, rotation_from_vector(t * turn)) < 1e-14);
    CHECK((at.twist.angular - turn).norm() < 1e-12);
  }
}

TEST_CASE("trajectory: holds its first and last pose, at rest") {
  // Oracle: the stated behaviour.
  const std::vector<TimedPose> samples = random_samples(4);
  const Trajectory trajectory(samples, false);
  for (const double outside : {-1e9, -0.1, 0.0}) {
    CHECK(trajectory.at(outside).pose.position == samples.front().pose.position);
    CHECK(trajectory.at(outside).twist.linear.norm() == 0);
    CHECK(trajectory.at(outside).twist.angular.norm() == 0);
  }
  for (const double beyond : {0.0, 0.1, 1e9}) {
    const DeviceSample at = trajectory.at(trajectory.duration() + beyond);
    CHECK((at.pose.position - samples.back().pose.position).norm() < 1e-16);
    CHECK(at.twist.linear.norm() == 0);
    CHECK(at.twist.angular.norm() == 0);
  }
}

TEST_CASE("trajectory: a loop returns within the stated time and then repeats") {
  // Oracle: analytic. Way back 0.1 m at 0.05 m/s: 2 s; then everything repeats.
  const std::vector<TimedPose> samples = {{0, {Vec3::Zero(), Quat::Identity()}},
                                          {1, {Vec3(0.1, 0, 0), Quat::Identity()}}};
  const Trajectory trajectory(samples, true);
  CHECK(trajectory.at(2).pose.position.x() == Approx(0.05));
  for (const double t : {0.0, 0.3, 1.0, 1.7, 2.9}) {
    // Rounding of t modulo 3 s over two periods, times 0.15 m/s.
    CHECK((trajectory.at(t + 6).pose.position - trajectory.at(t).pose.position).norm() < 1e-14);
  }
  // 0.01 m would take 0.2 s and takes 0.5 s; 1.5 rad take 1.5 s. Both are half done in the middle.
  const Trajectory brief({samples[0], {1, {Vec3(0.01, 0, 0), Quat::Identity()}}}, true);
  CHECK(brief.at(1.25).pose.position.x() == Approx(0.005));
  CHECK(brief.at(1.5 + 1).pose.position.x() == Approx(0.01));
  const Quat turn = rotation_from_vector(Vec3(0, 0, 1.5));
  const Trajectory turned({samples[0], {1, {Vec3::Zero(), turn}}}, true);
  CHECK(angle_between(turned.at(1.75).pose.rotation, Quat::Identity()) == Approx(0.75));
  CHECK(angle_between(turned.at(2.5 + 1).pose.rotation, turn) < 1e-9);
}
