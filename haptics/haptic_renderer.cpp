#include "haptics/haptic_renderer.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/core/error.h"

namespace palpate::haptics {
namespace {

/// 1 up to `stale_after`, then linearly to 0 within `fade_time`; 0 for an age that is no number.
double freshness(double age, const scene::Haptics& limits) {
  if (age <= limits.stale_after) return 1;
  const double factor = 1 - (age - limits.stale_after) / limits.fade_time;
  return factor > 0 ? factor : 0;
}

constexpr std::size_t kMaxCompliance = 3 * kMaxLawRows * (3 * kMaxLawRows + 1) / 2;

bool is_finite(const DeviceSample& device) {
  return device.pose.position.allFinite() && device.pose.rotation.coeffs().allFinite() &&
         device.twist.linear.allFinite() && device.twist.angular.allFinite();
}

}  // namespace

HapticRenderer::HapticRenderer(const scene::Haptics& limits, double period)
    : limits_(limits),
      period_(period),
      force_limiter_(limits.max_force, limits.max_force_rate * period),
      torque_limiter_(limits.max_force * kTorqueArm, limits.max_force_rate * period * kTorqueArm),
      passivity_(limits.device_damping, period) {
  PALPATE_DEMAND(period > 0);
  for (Received* received : {&current_, &next_}) {  // so that taking a law allocates nothing
    received->law.rows.reserve(kMaxLawRows);
    received->law.compliance.reserve(kMaxCompliance);
  }
}

void HapticRenderer::reset() {
  current_.valid = next_.valid = false;
  solver_.clear();
  passivity_.clear();
  cross_fade_left_ = 0;
  pressed_ = 0;
  refused_laws_ = 0;
  refused_since_tick_ = false;
}

void HapticRenderer::update_law(const LocalLaw& law, double time) {
  if (!is_usable(law) || !std::isfinite(time)) {
    ++refused_laws_;
    refused_since_tick_ = true;
    return;
  }
  next_.law = law;
  next_.time = time;
  next_.valid = true;
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
  Wrench passive_wrench = passive(wanted, device, limits);
  // Who has nothing to go by lets go: a debt must not hold the hand.
  const bool stale = freshness(age(current_, time), limits_) == 0;
  if (present == 0 || stale || is_near_nothing(time)) passive_wrench = {};
  const Vec3 damping = contact_damping(passive_wrench.force, device);
  passive_wrench.force += damping;
  out.force = force_limiter_.limit(passive_wrench.force, limits);
  // What cuts the force cuts the torque it exerts.
  const double length = passive_wrench.force.stableNorm();
  const double cut = length > 0 ? std::min(1.0, out.force.norm() / length) : 1;
  out.torque = torque_limiter_.limit(cut * passive_wrench.torque, limits);
  // What the damping takes in is lost and pays for nothing.
  passivity_.held({out.force - damping, out.torque});
  out.limits = limits;
  out.passivity_energy = passivity_.energy();
  out.contact_model_age = age(next_.valid ? next_ : current_, time);
}

/// A model from the future (a clock was set back) is as doubtful as one as far in the past.
double HapticRenderer::age(const Received& received, double time) const {
  if (!received.valid || !std::isfinite(time)) return std::numeric_limits<double>::infinity();
  return std::abs(time - received.time);
}

Wrench HapticRenderer::propose(const DeviceSample& device, double time, std::uint32_t& limits) {
  if (next_.valid) begin_cross_fade(device, time);
  if (cross_fade_left_ > 0) --cross_fade_left_;
  return wrench_at(device.pose, time, limits);
}

/// Law, what is left of the cross-fade, fade.
Wrench HapticRenderer::wrench_at(const Pose& pose, double time, std::uint32_t& limits) {
  if (!current_.valid) return {};
  const double old = age(current_, time);
  const LawForce modelled = solver_.evaluate(pose, current_.law.anchor_age + old);
  if (modelled.beyond_validity) limits |= kForceOutOfValidity;
  if (softening_ > 0) limits |= kStiffnessCapped;
  Wrench wrench = modelled.wrench;
  if (cross_fade_left_ > 0) {
    const double share = static_cast<double>(cross_fade_left_) / cross_fade_ticks_;
    wrench = wrench + share * cross_fade_;
    const Vec3& own = modelled.wrench.force;
    const double strength = own.norm();
    // A hand-over never pulls.
    if (strength > 0) {
      const Vec3 along = own / strength;
      wrench.force -= std::min(0.0, wrench.force.dot(along)) * along;
    }
  }
  const double factor = freshness(old, limits_);
  if (factor < 1) limits |= kForceStaleFade;
  return factor * wrench;
}

/// Of a silent driver the force fades as that of a stale law does; it rises again as slowly.
double HapticRenderer::presence(double silence) {
  presence_ = std::min(freshness(silence, limits_), presence_ + period_ / limits_.fade_time);
  return presence_;
}

/// Laws without rows go on coming of a probe in the open, and where contacts are heard of no more.
bool HapticRenderer::is_near_nothing(double time) const {
  return current_.valid && current_.law.rows.empty() && time - without_rows_ > kLetGo;
}

/// b/(T/2 + t_d), T the tick, b and t_d the device's damping and delay: the largest stiffness that
/// it can hold [N/m]; 0: nobody holds it.
double HapticRenderer::stable_stiffness(const DeviceSample& device) const {
  return device.delay ? limits_.device_damping / (period_ / 2 + *device.delay) : 0;
}

/// A law that is stiffer than the device can hold is softened to that from its anchor on. The
/// tissue meets the device's own pose: told the far end of a spring in series, with which it agrees
/// only a period later, it would be pressed and let go in turn under a hand at rest. Rows that do
/// not press yet tell no stiffness: what held before holds for them, too.
/// @returns the compliance that it gains [m/N]; 0: it is not capped, or nobody holds the device
double HapticRenderer::softening_of(const LocalLaw& law, const DeviceSample& device) const {
  const double stable = stable_stiffness(device);
  if (!(stable > 0)) return 0;
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(law.stiffness, Eigen::EigenvaluesOnly);
  const double stiffness = solver.eigenvalues().maxCoeff();
  if (!law.rows.empty() && !(stiffness > 0)) return softening_;
  return stiffness > stable ? 1 / stable - 1 / stiffness : 0;
}

/// Both laws are compared at the same place, so that only their difference is smoothed and
/// never the probe's motion.
void HapticRenderer::begin_cross_fade(const DeviceSample& device, double time) {
  std::uint32_t ignored = 0;
  const Wrench before = wrench_at(device.pose, time, ignored);
  const bool had_rows = !current_.valid || !current_.law.rows.empty();
  std::swap(current_, next_);
  next_.valid = false;
  if (had_rows) without_rows_ = time;
  const double spread = std::min(current_.law.period, kLongestCrossFade);
  cross_fade_ticks_ = std::max(1, static_cast<int>(std::lround(spread / period_)));
  softening_ = softening_of(current_.law, device);
  solver_.take(current_.law, softening_);
  cross_fade_left_ = 0;
  const Wrench after = wrench_at(device.pose, time, ignored);
  cross_fade_ = before - after;
  cross_fade_left_ = cross_fade_.is_finite() ? cross_fade_ticks_ : 0;
}

/// A contact that stiffens as it is pressed has taken in no more than half its force times the way
/// against it; a part of that is in the springs of the law already at first touch.
double HapticRenderer::returnable_energy(const Pose& pose, const Vec3& force) {
  constexpr double kMost = 1e3;  // [J]
  const double strength = force.stableNorm();
  if (strength > 0) {
    pressed_ = std::max(0.0, pressed_ - force.dot(pose.position - pressed_at_) / strength);
  }
  pressed_at_ = pose.position;
  const double energy = solver_.stored_energy() + strength * pressed_ / 2;
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

Wrench HapticRenderer::passive(const Wrench& wanted, const DeviceSample& device,
                               std::uint32_t& limits) {
  const bool apart = wanted.is_zero() && force_limiter_.output().isZero(0);
  if (apart || !is_finite(device)) {
    passivity_.clear();
    pressed_ = 0;
    pressed_at_ = device.pose.position;
    return wanted;
  }
  passivity_.observe(device.pose, returnable_energy(device.pose, wanted.force));
  const Wrench wrench = passivity_.controlled(wanted, device.twist);
  if (wrench != wanted) limits |= kForcePassivity;
  return wrench;
}

}  // namespace palpate::haptics
