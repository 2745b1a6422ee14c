// How far a point moves to and fro, and since when it is at rest: boxes around its places, ten a
// second, so that a long run needs no memory to speak of.
#pragma once

#include <optional>
#include <vector>

#include "modules/core/types.h"

namespace palpate::launcher {

class Swing {
 public:
  static constexpr double kSpan = 0.1;  ///< of a box [s]

  /// @param time  [s], never decreasing, from 0
  void add(double time, const Vec3& position);

  /// Peak to peak within the last second, the diagonal of the box around it [m].
  double last_second() const;
  /// Since when all places lie in one box of this diagonal [m], in whole spans [s]; nothing if
  /// that is not before the last span.
  std::optional<double> rests_since(double diagonal) const;

 private:
  struct Box {
    Vec3 low, high;
    void include(const Box& other) {
      low = low.cwiseMin(other.low);
      high = high.cwiseMax(other.high);
    }
    double diagonal() const { return (high - low).norm(); }
  };
  std::vector<Box> boxes_;  ///< of each span
};

}  // namespace palpate::launcher
