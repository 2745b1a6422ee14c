#include "haptics/force_limits.h"

#include "modules/core/touch.h"
#include "modules/core/vector_checks.h"

namespace palpate::haptics {

const Vec3& ForceLimiter::limit(const Vec3& wanted, std::uint32_t& limits) {
  const bool finite = wanted.allFinite();
  if (!finite) limits |= kForceNotFinite;
  // Both are halved so that the difference of two finite numbers cannot overflow.
  const Vec3 half_step = finite ? Vec3(0.5 * wanted - 0.5 * output_) : Vec3(-0.5 * output_);
  if (is_longer_than(half_step, 0.5 * max_step_)) {
    limits |= kForceSlewLimited;
    output_ += 2 * clamp_length(half_step, 0.5 * max_step_);
  } else if (finite) {
    output_ = wanted;
  } else {
    output_.setZero();
  }
  if (is_longer_than(output_, max_length_)) {
    limits |= kForceSaturated;
    output_ = clamp_length(output_, max_length_);
  }
  return output_;
}

}  // namespace palpate::haptics
