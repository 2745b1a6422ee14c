// Vocabulary types shared by every layer. SI units; frame W (world, right-handed, z up) unless
// said.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

/// Pose X_WB of a body B in the world.
struct Pose {
  Vec3 position = Vec3::Zero();      ///< p_WB [m]
  Quat rotation = Quat::Identity();  ///< unit quaternion R_WB

  Vec3 to_world(const Vec3& p_B) const { return position + rotation * p_B; }
  Vec3 to_body(const Vec3& p_W) const { return rotation.conjugate() * (p_W - position); }
};

/// Velocity of a body in the world.
struct Twist {
  Vec3 linear = Vec3::Zero();   ///< of the body's origin [m/s]
  Vec3 angular = Vec3::Zero();  ///< [rad/s]

  /// Velocity [m/s] of the body-fixed point at p_W, for a body whose origin is at origin_W.
  Vec3 at(const Vec3& p_W, const Vec3& origin_W) const {
    return linear + angular.cross(p_W - origin_W);
  }
};

}  // namespace palpate
