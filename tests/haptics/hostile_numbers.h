// Numbers as a broken process might send them.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "modules/core/types.h"

namespace palpate::haptics {

class HostileNumbers {
 public:
  explicit HostileNumbers(unsigned seed) : random_(seed) {}

  /// Ordinary three times out of four, else NaN, infinite, denormal, or huge.
  double number() {
    using Limits = std::numeric_limits<double>;
    const std::array<double, 12> kinds = {Limits::quiet_NaN(),
                                          Limits::infinity(),
                                          -Limits::infinity(),
                                          1e308,
                                          -1e308,
                                          Limits::max(),
                                          Limits::denorm_min(),
                                          -Limits::denorm_min(),
                                          Limits::min(),
                                          -0.0,
                                          1e154,
                                          -1e-160};
    if (below(4) < 3) return ordinary_(random_);
    return kinds[below(kinds.size())];
  }
  /// Ordinary throughout nine times out of ten.
  Vec3 vector() {
    if (below(10) < 9) return 5 * Vec3(ordinary_(random_), ordinary_(random_), ordinary_(random_));
    return Vec3(number(), number(), number());
  }
  std::size_t below(std::size_t n) { return random_() % n; }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> ordinary_;
};

}  // namespace palpate::haptics
