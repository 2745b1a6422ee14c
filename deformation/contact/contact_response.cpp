#include "deformation/contact/contact_response.h"

#include <algorithm>
#include <cmath>

namespace palpate::deformation {
namespace {

constexpr double kMemory = 1e-3;       // of path [m]
constexpr double kPriorMotion = 1e-5;  // [m]; until the probe moved this far there is no estimate
constexpr double kTangentialRatio = 2.0 / 3.0;

}  // namespace

void ContactResponse::reset() { *this = ContactResponse(); }

void ContactResponse::begin(double period) {
  period_ = period;
  impulse_ = angular_impulse_ = normal_sum_ = Vec3::Zero();
}

void ContactResponse::add(const Vec3& impulse, const Vec3& normal, const Vec3& p_W,
                          const Vec3& origin_W) {
  impulse_ += impulse;
  angular_impulse_ += (p_W - origin_W).cross(impulse);
  normal_sum_ += impulse.dot(normal) * normal;
}

void ContactResponse::end(const Vec3& probe_origin, double stiffness_limit) {
  touching_ = normal_sum_.norm() > 0;
  const Vec3 moved = probe_origin - origin_;
  const double last_normal_force = normal_force_;
  force_ = impulse_ / period_;
  torque_ = angular_impulse_ / period_;
  origin_ = probe_origin;
  if (!touching_) {
    normal_force_ = motion_squared_ = motion_times_force_ = stiffness_ = 0;
    touched_before_ = false;
    return;
  }
  normal_ = normal_sum_.normalized();
  normal_force_ = force_.dot(normal_);
  if (touched_before_) {
    const double step = normal_.dot(moved);
    const double keep = std::exp(-std::abs(step) / kMemory);
    motion_squared_ = keep * motion_squared_ + step * step;
    motion_times_force_ = keep * motion_times_force_ + step * (normal_force_ - last_normal_force);
    stiffness_ = std::clamp(-motion_times_force_ / (motion_squared_ + kPriorMotion * kPriorMotion),
                            0.0, stiffness_limit);
  }
  touched_before_ = true;
}

void ContactResponse::write(LocalLaw& out) const {
  out.touching = touching_;
  out.anchor = origin_;
  out.force = force_;
  out.torque = torque_;
  out.normal = normal_;
  out.stiffness = stiffness_ * (kTangentialRatio * Mat3::Identity() +
                                (1 - kTangentialRatio) * normal_ * normal_.transpose());
}

}  // namespace palpate::deformation
