// How old what a source says usually gets before it says more: what is older has stopped coming.
#pragma once

#include <algorithm>

#include "modules/core/state_archive.h"

namespace palpate::deformation {

class UsualAge {
 public:
  static constexpr double kLeast = 0.010;   ///< what is no older is not late by itself [s]
  static constexpr double kForgotten = 10;  ///< an age that did not come again for so long [s]

  /// @param silent  an age from which a source is silent: how old things get then is not usual [s]
  /// @param period  what comes so far apart is not late either [s]
  UsualAge(double silent, double period) : silent_(silent), least_(std::max(kLeast, period)) {}

  /// Something came; what was before it had got so old [s].
  /// @param since  the call before [s]
  void note(double age, double since) {
    worst_ *= std::clamp(1 - since / kForgotten, 0.0, 1.0);
    if (age < silent_) worst_ = std::max(worst_, age);
  }
  double limit() const { return std::max(least_, worst_); }  ///< [s]

  void exchange(StateArchive& archive) { archive(worst_); }

 private:
  double silent_, least_, worst_ = 0;
};

}  // namespace palpate::deformation
