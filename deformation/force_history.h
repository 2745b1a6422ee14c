// The mean forces on a probe over the last advances.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "modules/core/state_archive.h"
#include "modules/core/types.h"

namespace palpate::deformation {

class ForceHistory {
 public:
  /// Forces that change faster than this part of themselves in a period are not taken to go on so.
  static constexpr double kMostGrowth = 0.5;
  /// Periods over which forces are compared. A law is used for up to a period and a half more, and
  /// would enlarge a change over fewer periods than that, which may be a mere chatter of contacts.
  static constexpr std::size_t kPeriods = 3;

  /// @param force  over the advance that just ended [N]
  void note(const Vec3& force) {
    std::shift_right(forces_.begin(), forces_.end(), 1);
    forces_.front() = force;
  }
  const Vec3& newest() const { return forces_.front(); }

  /// How fast the force grew over the last kPeriods advances, in the mean; 0 where there was none
  /// an advance before, and where it fell though the tissue is pressed in further, or grew though
  /// that comes back: its swing, which does not go on [1/s].
  /// @param period    of an advance [s]
  /// @param yielding  how fast tissue gives way to the forces: their power on it [W]
  double growth(double period, double yielding) const {
    const Vec3 &now = forces_.front(), &then = forces_.back();
    const double strength = now.norm();
    if (!(strength > 0) || forces_[1].isZero(0) || !(period > 0)) return 0;
    const double grown = (now - then).dot(now) / (strength * strength) / kPeriods;
    if (grown * yielding < 0) return 0;
    return std::clamp(grown, -kMostGrowth, kMostGrowth) / period;
  }

  void exchange(StateArchive& archive) { archive(forces_); }

 private:
  std::array<Vec3, kPeriods + 1> forces_{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
};

}  // namespace palpate::deformation
