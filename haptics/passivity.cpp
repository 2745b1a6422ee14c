#include "haptics/passivity.h"

#include <algorithm>
#include <cmath>

namespace palpate::haptics {
namespace {

constexpr double kReserve = 2;  ///< times the returnable energy
/// Slower than this there is no power to speak of: 3 N give 3 µW [m/s].
constexpr double kStandstill = 1e-6;

}  // namespace

void Passivity::observe(const Vec3& position, double returnable) {
  if (has_position_) {
    const Vec3 motion = position - position_;
    const double gained = -held_force_.dot(motion) + damping_ * motion.squaredNorm() / period_;
    if (std::isfinite(gained)) energy_ += gained;
    energy_ = std::clamp(energy_, -kMaxDebt, kReserve * returnable);
  }
  position_ = position;
  has_position_ = true;
}

Vec3 Passivity::controlled(const Vec3& wanted, const Vec3& velocity) const {
  const double speed = velocity.stableNorm();
  if (!(speed > kStandstill) || !std::isfinite(speed)) return wanted;
  const Vec3 direction = velocity / speed;
  const double push = wanted.dot(direction);
  const double energy_after = energy_ - period_ * speed * (push - damping_ * speed);
  if (!(energy_after < 0)) return wanted;
  const double needed = -energy_after / (period_ * speed);
  const double allowed = std::max(0.0, push) + kMaxAddedDamping * speed;
  return wanted - std::min(needed, allowed) * direction;
}

void Passivity::clear() {
  energy_ = 0;
  has_position_ = false;
  held_force_.setZero();
}

}  // namespace palpate::haptics
