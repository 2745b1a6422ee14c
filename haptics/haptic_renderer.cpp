#include "haptics/haptic_renderer.h"

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

/// |f|²/(2k), k the stiffness along the normal, at least 1 N/m; at most 1 kJ.
double returnable_energy(const LocalLaw& law, const Vec3& p_W) {
  constexpr double kSoftest = 1, kMost = 1e3;  // [N/m], [J]
  const double stiffness = law.normal.dot(law.stiffness * law.normal);
  const double energy =
      evaluate(law, p_W).wrench.force.squaredNorm() / (2 * std::max(kSoftest, stiffness));
  return energy < kMost ? energy : kMost;
}

bool is_finite(const DeviceSample& device) {
  return device.pose.position.allFinite() && device.twist.linear.allFinite();
}

}  // namespace

HapticRenderer::HapticRenderer(const scene::Haptics& limits, double period)
    : limits_(limits),
      period_(period),
      force_limiter_(limits.max_force, limits.max_force_rate * period),
      torque_limiter_(limits.max_force * kTorqueArm, limits.max_force_rate * period * kTorqueArm),
      passivity_(limits.device_damping, period) {
  PALPATE_DEMAND(period > 0);
}

void HapticRenderer::reset() { *this = HapticRenderer(limits_, period_); }

void HapticRenderer::update_law(const LocalLaw& law, double time) {
  if (!is_usable(law) || !std::isfinite(time)) {
    ++refused_laws_;
    refused_since_tick_ = true;
    return;
  }
  next_ = {law, time, true};
}

void HapticRenderer::tick(double time, const DeviceSample& device, RenderedForce& out) {
  std::uint32_t limits = refused_since_tick_ ? kForceNotFinite : kForceNotLimited;
  refused_since_tick_ = false;
  Wrench wanted;
  if (is_finite(device)) {
    wanted = propose(device.pose.position, time, limits);
  } else {
    limits |= kForceNotFinite;
  }
  if (!wanted.is_finite()) {
    limits |= kForceNotFinite;
    wanted = {};
  }
  out.force = force_limiter_.limit(passive_force(wanted.force, device, limits), limits);
  passivity_.held(out.force);

  // What cuts the force cuts the torque it exerts.
  const double wanted_length = wanted.force.stableNorm();
  const double cut = wanted_length > 0 ? std::min(1.0, out.force.norm() / wanted_length) : 1;
  out.torque = torque_limiter_.limit(cut * wanted.torque, limits);
  out.limits = limits;
  out.passivity_energy = passivity_.energy();
  out.contact_model_age = age(next_.valid ? next_ : current_, time);
}

/// A model from the future (a clock was set back) is as doubtful as one as far in the past.
double HapticRenderer::age(const Received& received, double time) const {
  if (!received.valid || !std::isfinite(time)) return std::numeric_limits<double>::infinity();
  return std::abs(time - received.time);
}

Wrench HapticRenderer::propose(const Vec3& p_W, double time, std::uint32_t& limits) {
  if (next_.valid) begin_cross_fade(p_W, time);
  if (cross_fade_left_ > 0) --cross_fade_left_;
  return wrench_at(p_W, time, limits);
}

/// Model, what is left of the cross-fade, fade.
Wrench HapticRenderer::wrench_at(const Vec3& p_W, double time, std::uint32_t& limits) const {
  if (!current_.valid) return {};
  const LocalLaw& law = current_.law;
  const LawForce modelled = evaluate(law, p_W);
  if (modelled.beyond_validity) limits |= kForceOutOfValidity;
  Wrench wrench = modelled.wrench;
  if (cross_fade_left_ > 0) {
    const double share = static_cast<double>(cross_fade_left_) / cross_fade_ticks_;
    wrench.force += share * cross_fade_.force;
    wrench.torque += share * cross_fade_.torque;
    if (law.touching) wrench.force -= std::min(0.0, wrench.force.dot(law.normal)) * law.normal;
  }
  const double factor = freshness(age(current_, time), limits_);
  if (factor < 1) limits |= kForceStaleFade;
  return {factor * wrench.force, factor * wrench.torque};
}

/// Both models are compared at the same place, so that only their difference is smoothed and
/// never the probe's motion.
void HapticRenderer::begin_cross_fade(const Vec3& p_W, double time) {
  std::uint32_t ignored = 0;
  const Wrench before = wrench_at(p_W, time, ignored);
  const double since_last = current_.valid ? std::abs(next_.time - current_.time) : kCrossFadeTime;
  cross_fade_ticks_ =
      std::max(1, static_cast<int>(std::lround(std::min(since_last, kCrossFadeTime) / period_)));
  current_ = next_;
  next_.valid = false;
  cross_fade_left_ = 0;
  const Wrench after = wrench_at(p_W, time, ignored);
  cross_fade_ = {before.force - after.force, before.torque - after.torque};
  cross_fade_left_ = cross_fade_.is_finite() ? cross_fade_ticks_ : 0;
}

Vec3 HapticRenderer::passive_force(const Vec3& wanted, const DeviceSample& device,
                                   std::uint32_t& limits) {
  const bool apart = wanted.isZero(0) && force_limiter_.output().isZero(0);
  if (apart || !is_finite(device)) {
    passivity_.clear();
    return wanted;
  }
  const Vec3& p_W = device.pose.position;
  passivity_.observe(p_W, returnable_energy(current_.law, p_W));
  const Vec3 force = passivity_.controlled(wanted, device.twist.linear);
  if (force != wanted) limits |= kForcePassivity;
  return force;
}

}  // namespace palpate::haptics
