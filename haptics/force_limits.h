// Final limits on what reaches a device: a value that is not finite becomes zero, then the change
// per tick is limited, then the magnitude.
//
// Both bounds hold at once: the previous output lies in the ball |f| ≤ max; the slew step moves it
// by at most max_step; projecting onto a ball never lengthens a distance and leaves the previous
// output where it is, so the projected result is still within max_step of it.
#pragma once

#include <cstdint>

#include "modules/core/state_archive.h"
#include "modules/core/types.h"

namespace palpate::haptics {

/// Limits one vector (a force, or a torque) from tick to tick, starting from zero.
class ForceLimiter {
 public:
  /// @param max_length  of the output [N or N·m], > 0
  /// @param max_step    of the output from one call to the next [the same unit], > 0
  ForceLimiter(double max_length, double max_step) : max_length_(max_length), max_step_(max_step) {}

  /// The output nearest to `wanted` in the sense above; any input whatever. What was done is added
  /// to `limits` as ForceLimit bits. Bounds hold within 1e-12 of max_length (rounding).
  const Vec3& limit(const Vec3& wanted, std::uint32_t& limits);

  const Vec3& output() const { return output_; }  ///< of the last call

  void exchange(StateArchive& archive) { archive(output_); }

 private:
  double max_length_, max_step_;
  Vec3 output_ = Vec3::Zero();
};

}  // namespace palpate::haptics
