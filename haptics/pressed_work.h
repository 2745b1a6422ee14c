// What a contact could give back at most: what it took to press the probe to where it is. Half the
// force times the way would do where a contact stiffens as it is pressed; a shell gives way, and
// gives back more.
#pragma once

#include <array>

#include "modules/core/error.h"
#include "modules/core/state_archive.h"
#include "modules/core/types.h"

namespace palpate::haptics {

class PressedWork {
 public:
  /// The probe has come to `position` [m].
  /// @param force     of the contact on it there [N]
  /// @param pressing  what of that is normal to the tissue [N]: friction gives nothing back
  void move(const Vec3& position, const Vec3& force, const Vec3& pressing);

  /// Contact is over, the probe at `position` [m].
  void clear(const Vec3& position);

  /// [J] ≥ 0: what it took to press the probe so deep, or half the force times the way against it,
  /// which is more where tissue came to the probe.
  double returnable() const;

  void exchange(StateArchive& archive) {
    archive(at_, strength_, way_, depth_, work_, width_, knot_, works_);
    if (!(width_ > 0) || knot_ + 1 >= kKnots) throw InputError("its state is no pressed work");
  }

 private:
  static constexpr std::size_t kKnots = 64;
  static constexpr double kFinest = 1e-4;  ///< [m]

  void press(double by, double force);
  void release(double by);
  void widen(double depth);
  double depth_of(std::size_t knot) const { return static_cast<double>(knot) * width_; }

  Vec3 at_ = Vec3::Zero();
  double strength_ = 0;  ///< of the force [N]
  double way_ = 0;       ///< against the force since touch, ≥ 0 [m]
  double depth_ = 0;     ///< against what presses since touch, ≥ 0 [m]
  double work_ = 0;      ///< done against it to get there [J]
  // The work at depths 0, w, 2 w …, as they were last passed on the way in.
  double width_ = kFinest;  ///< w [m]
  std::size_t knot_ = 0;    ///< the deepest above depth_
  std::array<double, kKnots> works_{};
};

}  // namespace palpate::haptics
