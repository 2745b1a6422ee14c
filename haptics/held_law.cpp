#include "haptics/held_law.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::haptics {
namespace {

constexpr std::size_t kMaxCompliance = 3 * kMaxLawRows * (3 * kMaxLawRows + 1) / 2;

}  // namespace

double freshness(double age, double stale_after, double fade_time) {
  if (age <= stale_after) return 1;
  const double factor = 1 - (age - stale_after) / fade_time;
  return factor > 0 ? factor : 0;
}

HeldLaw::HeldLaw(const scene::Haptics& limits, double period)
    : stale_after_(limits.stale_after), fade_time_(limits.fade_time), period_(period) {
  for (Received* received : {&current_, &next_}) {  // so that taking a law allocates nothing
    received->law.rows.reserve(kMaxLawRows);
    received->law.compliance.reserve(kMaxCompliance);
  }
}

void HeldLaw::receive(const LocalLaw& law, double time) {
  next_.law = law;
  next_.time = time;
  next_.valid = true;
}

void HeldLaw::clear() {
  current_.valid = next_.valid = false;
  solver_.clear();
  felt_ = false;
  pressing_.setZero();
  unfaded_ = {};
  cross_fade_left_ = 0;
}

/// A model from the future (a clock was set back) is as doubtful as one as far in the past.
double HeldLaw::age(const Received& received, double time) {
  if (!received.valid || !std::isfinite(time)) return std::numeric_limits<double>::infinity();
  return std::abs(time - received.time);
}

/// Laws without rows go on coming of a probe in the open, and where contacts are heard of no more.
bool HeldLaw::tells_nothing(double time) const {
  if (freshness(age(time), stale_after_, fade_time_) == 0) return true;
  return current_.law.rows.empty() && time - without_rows_ > kLetGo;
}

Wrench HeldLaw::wrench_at(const Pose& pose, double time, std::uint32_t& limits) {
  felt_ = false;
  pressing_.setZero();
  unfaded_ = {};
  if (!current_.valid) return {};
  const double old = age(time);
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
  const double factor = freshness(old, stale_after_, fade_time_);
  if (factor < 1) limits |= kForceStaleFade;
  felt_ = factor > 0;
  pressing_ = modelled.pressing;
  unfaded_ = wrench;
  return factor * wrench;
}

void HeldLaw::take_next(const Pose& pose, double time, double softening) {
  std::uint32_t ignored = 0;
  const Wrench before = wrench_at(pose, time, ignored);
  const bool had_rows = !current_.valid || !current_.law.rows.empty();
  std::swap(current_, next_);
  next_.valid = false;
  if (had_rows) without_rows_ = time;
  const double spread = std::min(current_.law.period, kLongestCrossFade);
  cross_fade_ticks_ = std::max(1, static_cast<int>(std::lround(spread / period_)));
  if (softening >= 0) softening_ = softening;
  solver_.take(current_.law, softening_);
  cross_fade_left_ = 0;
  const Wrench after = wrench_at(pose, time, ignored);
  cross_fade_ = before - after;
  cross_fade_left_ = cross_fade_.is_finite() ? cross_fade_ticks_ : 0;
}

}  // namespace palpate::haptics
