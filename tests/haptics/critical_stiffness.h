// Where a closed loop's border of stability lies.
#pragma once

#include <cmath>

namespace palpate {

/// Smallest stiffness [N/m] at which a motion grows, by bisection to 1 %.
/// @param grows  of a stiffness between 1 and `highest`
template <class Grows>
double critical_stiffness(double highest, const Grows& grows) {
  double low = 1, high = highest;
  while (high / low > 1.01) {
    const double middle = std::sqrt(low * high);
    (grows(middle) ? high : low) = middle;
  }
  return low;
}

}  // namespace palpate
