#include "haptics/energy_credit.h"

#include <algorithm>
#include <cmath>

namespace palpate::haptics {

double EnergyCredit::limit(double wanted, double stiffness, double put_in, double speed) {
  // Bounded, so that a speed that is none is forgotten.
  const double square = std::min(speed * speed, 1.0);
  square_speed_ += (square - square_speed_) * std::min(1.0, period_ / kStillTime);
  const double loaded = wanted * wanted / (2 * stiffness);
  if (square_speed_ < kStill * kStill) granted_ += loaded * period_ / kGrantTime;
  granted_ = std::clamp(granted_, 0.0, std::max(0.0, loaded - put_in));
  return std::min(wanted, std::sqrt(2 * stiffness * std::max(0.0, put_in + granted_)));
}

void EnergyCredit::clear() {
  granted_ = 0;
  square_speed_ = kStill * kStill;
}

}  // namespace palpate::haptics
