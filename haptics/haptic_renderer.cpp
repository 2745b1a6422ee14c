#include "haptics/haptic_renderer.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/core/error.h"

namespace palpate::haptics {
namespace {

double largest_eigenvalue(const Mat3& matrix) {
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(matrix, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().maxCoeff();
}

bool is_finite(const DeviceSample& device) {
  return device.pose.position.allFinite() && device.pose.rotation.coeffs().allFinite() &&
         device.twist.linear.allFinite() && device.twist.angular.allFinite();
}

}  // namespace

HapticRenderer::HapticRenderer(const scene::Haptics& limits, double period, std::size_t sources)
    : limits_(limits),
      period_(period),
      force_limiter_(limits.max_force, limits.max_force_rate * period),
      torque_limiter_(limits.max_force * kTorqueArm, limits.max_force_rate * period * kTorqueArm),
      passivity_(limits.device_damping, period) {
  PALPATE_DEMAND(period > 0);
  for (std::size_t i = 0; i < sources; ++i) laws_.emplace_back(limits, period);
}

void HapticRenderer::reset() {
  for (HeldLaw& law : laws_) law.clear();
  passivity_ = PassivityControl(limits_.device_damping, period_);
  pressed_ = {};
  refused_laws_ = 0;
  refused_since_tick_ = false;
}

void HapticRenderer::update_law(const LocalLaw& law, double time, std::size_t source) {
  if (source >= laws_.size() || !is_usable(law) || !std::isfinite(time)) {
    ++refused_laws_;
    refused_since_tick_ = true;
    return;
  }
  laws_[source].receive(law, time);
}

void HapticRenderer::tick(double time, const DeviceSample& device, RenderedForce& out) {
  std::uint32_t limits = device.limits;
  if (refused_since_tick_) limits |= kForceNotFinite;
  refused_since_tick_ = false;
  Wrench wanted;
  if (is_finite(device)) {
    wanted = propose(device, time, limits);
  } else {
    limits |= kForceNotFinite;
  }
  if (!wanted.is_finite()) {
    limits |= kForceNotFinite;
    wanted = {};
  }
  const double present = presence(device.silence);
  if (present < 1) limits |= kDriverSilent;
  wanted = present * wanted;
  Wrench unfaded;
  for (const HeldLaw& law : laws_) unfaded = unfaded + law.unfaded();
  if (!unfaded.is_finite()) unfaded = wanted;
  Wrench passive_wrench = passive(wanted, unfaded, device, limits);
  // Who has nothing to go by lets go: a debt must not hold the hand.
  if (present == 0 || tells_nothing(time)) passive_wrench = {};
  const Vec3 damping = contact_damping(passive_wrench.force, device);
  passive_wrench.force += damping;
  out.force = force_limiter_.limit(passive_wrench.force, limits);
  // What cuts the force cuts the torque it exerts.
  const double length = passive_wrench.force.stableNorm();
  const double cut = length > 0 ? std::min(1.0, out.force.norm() / length) : 1;
  out.torque = torque_limiter_.limit(cut * passive_wrench.torque, limits);
  // What the damping takes in is lost and pays for nothing. What a fade takes away is the tissue's
  // all the same: a hand that came deeper meanwhile has pressed it there.
  passivity_.held({out.force - damping + (unfaded.force - wanted.force),
                   out.torque + (unfaded.torque - wanted.torque)});
  out.limits = limits;
  out.passivity_energy = passivity_.energy();
  out.contact_model_age = newest_age(time);
}

/// Of all sources' laws.
Wrench HapticRenderer::propose(const DeviceSample& device, double time, std::uint32_t& limits) {
  Wrench sum;
  for (HeldLaw& law : laws_) {
    if (law.has_next()) law.take_next(device.pose, time, softening_of(law, device));
    law.pass_tick();
    sum = sum + law.wrench_at(device.pose, time, limits);
  }
  return sum;
}

bool HapticRenderer::tells_nothing(double time) const {
  return std::ranges::all_of(laws_, [&](const HeldLaw& law) { return law.tells_nothing(time); });
}

/// Of the source that is behind the others.
double HapticRenderer::newest_age(double time) const {
  double age = 0;
  for (const HeldLaw& law : laws_) age = std::max(age, law.newest_age(time));
  return age;
}

/// Of a silent driver the force fades as that of a stale law does; it rises again as slowly.
double HapticRenderer::presence(double silence) {
  const double heard = freshness(silence, limits_.stale_after, limits_.fade_time);
  presence_ = std::min(heard, presence_ + period_ / limits_.fade_time);
  return presence_;
}

/// b/(T/2 + t_d), T the tick, b and t_d the device's damping and delay: the largest stiffness that
/// it can hold [N/m]; 0: nobody holds it.
double HapticRenderer::stable_stiffness(const DeviceSample& device) const {
  return device.delay ? limits_.device_damping / (period_ / 2 + *device.delay) : 0;
}

/// Laws that together are stiffer than the device can hold are softened to that from their anchors
/// on, each by its part. The tissue meets the device's own pose: told the far end of a spring in
/// series, with which it agrees only a period later, it would be pressed and let go in turn under a
/// hand at rest. Rows that do not press yet tell no stiffness: what held before holds for them,
/// too.
/// @returns the compliance that it gains [m/N]; 0: it is not capped, or nobody holds the device;
///          below 0: as before
double HapticRenderer::softening_of(const HeldLaw& law, const DeviceSample& device) const {
  const double stable = stable_stiffness(device);
  if (!(stable > 0)) return 0;
  const double own = largest_eigenvalue(law.next().stiffness);
  if (!law.next().rows.empty() && !(own > 0)) return -1;
  Mat3 others = Mat3::Zero();
  for (const HeldLaw& other : laws_) {
    if (&other != &law) others += other.felt_stiffness();
  }
  const bool alone = others.isZero(0);
  const double all = alone ? own : largest_eigenvalue(law.next().stiffness + others);
  if (!(all > stable) || !(own > 0)) return 0;
  const double softening = 1 / stable - 1 / all;
  return alone ? softening : all / own * softening;
}

/// What it took to press the probe there; a part of that is in the springs of the law already at
/// first touch.
double HapticRenderer::returnable_energy(const Pose& pose, const Vec3& force) {
  constexpr double kMost = 1e3;  // [J]
  Vec3 pressing = Vec3::Zero();
  for (const HeldLaw& law : laws_) pressing += law.pressing();
  pressed_.move(pose.position, force, pressing);
  double energy = pressed_.returnable();
  for (const HeldLaw& law : laws_) energy += law.stored_energy();
  return energy < kMost ? energy : kMost;
}

/// In contact a held device is damped beyond its own, along the force: on soft tissue that lets it
/// swing for seconds.
Vec3 HapticRenderer::contact_damping(const Vec3& force, const DeviceSample& device) const {
  const double strength = force.stableNorm();
  if (!(stable_stiffness(device) > 0) || !(strength > 0) || !is_finite(device)) {
    return Vec3::Zero();
  }
  const Vec3 along = force / strength;
  const double most = kMostDamped * strength;
  const double loss = kContactDamping * device.twist.linear.dot(along);
  return -std::clamp(loss, -most, most) * along;
}

Wrench HapticRenderer::passive(const Wrench& wanted, const Wrench& unfaded,
                               const DeviceSample& device, std::uint32_t& limits) {
  const bool apart = unfaded.is_zero() && force_limiter_.output().isZero(0);
  if (apart || !is_finite(device)) {
    passivity_.clear();
    if (is_finite(device)) passivity_.watch(device.pose);
    pressed_.clear(device.pose.position);
    return wanted;
  }
  passivity_.observe(device.pose, returnable_energy(device.pose, unfaded.force));
  const Wrench wrench = passivity_.controlled(wanted, device.twist);
  if (wrench != wanted) limits |= kForcePassivity;
  return wrench;
}

}  // namespace palpate::haptics
