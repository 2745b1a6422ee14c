// How old what a source says usually gets before it says more: what is older has stopped coming.
#pragma once

#include <algorithm>

#include "modules/core/state_archive.h"

namespace palpate::deformation {

class UsualAge {
 public:
  static constexpr double kLeast = 0.010;   ///< older than this nothing is by itself late [s]
  static constexpr double kForgotten = 10;  ///< an age that did not come again for so long [s]

  /// @param silent  an age from which a source is silent: how old things get then is not usual [s]
  explicit UsualAge(double silent) : silent_(silent) {}

  /// Something came; what was before it had got so old [s].
  /// @param since  the call before [s]
  void note(double age, double since) {
    worst_ *= std::clamp(1 - since / kForgotten, 0.0, 1.0);
    if (age < silent_) worst_ = std::max(worst_, age);
  }
  double limit() const { return std::max(kLeast, worst_); }  ///< [s]

  void exchange(StateArchive& archive) { archive(worst_); }

 private:
  double silent_, worst_ = 0;
};

}  // namespace palpate::deformation
