#include "modules/core/types.h"

#include <catch2/catch.hpp>
#include <numbers>
#include <random>

using namespace palpate;

namespace {

// Rounding of a rotation and a sum at metre size: some ten units in the last place.
constexpr double kRounding = 1e-14;

Pose random_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  Pose pose;
  pose.position = Vec3(number(random), number(random), number(random));
  pose.rotation = Quat(number(random), number(random), number(random), number(random)).normalized();
  return pose;
}

}  // namespace

TEST_CASE("pose: a default pose leaves points where they are") {
  // Oracle: identity.
  const Vec3 point(0.1, -0.2, 0.3);
  CHECK(Pose{}.to_world(point) == point);
  CHECK(Pose{}.to_body(point) == point);
}

TEST_CASE("pose: rotates first, then translates") {
  // Oracle: by hand; a quarter turn about z takes x to y.
  Pose pose;
  pose.position = Vec3(1, 2, 3);
  pose.rotation = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ());
  CHECK((pose.to_world(Vec3(1, 0, 0)) - Vec3(1, 3, 3)).norm() < kRounding);
  CHECK((pose.to_body(Vec3(1, 3, 3)) - Vec3(1, 0, 0)).norm() < kRounding);
}

TEST_CASE("pose: to_body undoes to_world, and distances are kept") {
  // Oracle: invariants of rigid motion, over seeded random poses.
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Pose pose = random_pose(random);
    const Vec3 a = random_pose(random).position, b = random_pose(random).position;
    CHECK((pose.to_body(pose.to_world(a)) - a).norm() < kRounding);
    CHECK(std::abs((pose.to_world(a) - pose.to_world(b)).norm() - (a - b).norm()) < kRounding);
  }
}

TEST_CASE("pose: agrees with the homogeneous transform of Eigen") {
  // Oracle: independent tool, Eigen::Isometry3d.
  std::mt19937 random(2);
  for (int i = 0; i < 20; ++i) {
    const Pose pose = random_pose(random);
    const Vec3 point = random_pose(random).position;
    Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
    transform.linear() = pose.rotation.toRotationMatrix();
    transform.translation() = pose.position;
    CHECK((pose.to_world(point) - transform * point).norm() < kRounding);
    CHECK((pose.to_body(point) - transform.inverse() * point).norm() < kRounding);
  }
}

TEST_CASE("twist: the origin moves linearly, other points turn about it") {
  // Oracle: by hand; 2 rad/s about z at 0.5 m gives 1 m/s.
  Twist twist;
  twist.linear = Vec3(0.1, 0, 0);
  twist.angular = Vec3(0, 0, 2);
  const Vec3 origin(1, 1, 1);
  CHECK(twist.at(origin, origin) == twist.linear);
  CHECK((twist.at(origin + Vec3(0.5, 0, 0), origin) - Vec3(0.1, 1, 0)).norm() < kRounding);
}

TEST_CASE("twist: is the time derivative of the points of a moving pose") {
  // Oracle: central finite difference of Pose::to_world over 2·10⁻⁵ s; error (ω h)² ≈ 1e-9 of the
  // speed, plus rounding 1e-16 / 1e-5.
  std::mt19937 random(3);
  const double h = 1e-5;
  for (int i = 0; i < 20; ++i) {
    const Pose pose = random_pose(random);
    const Twist twist{random_pose(random).position, random_pose(random).position};
    const Vec3 body_point = random_pose(random).position;
    const auto at = [&](double time) {
      Pose moved;
      moved.position = pose.position + twist.linear * time;
      moved.rotation = Eigen::AngleAxisd(twist.angular.norm() * time, twist.angular.normalized()) *
                       pose.rotation;
      return moved.to_world(body_point);
    };
    const Vec3 difference = (at(h) - at(-h)) / (2 * h);
    const Vec3 exact = twist.at(pose.to_world(body_point), pose.position);
    CHECK((difference - exact).norm() < 1e-8);
  }
}
