#include "modules/runtime/cycle_budget.h"

#include <algorithm>

namespace palpate::runtime {
namespace {
constexpr double kWeightOfNewest = 0.1;  // a single interruption does not shorten the next cycle
}

double CycleBudget::next() const {
  if (wall_per_simulated_ <= 1) return period_;
  return std::max(std::min(least_, period_), period_ / wall_per_simulated_);
}

void CycleBudget::took(double simulated, double wall) {
  const double newest = wall / simulated;
  wall_per_simulated_ =
      wall_per_simulated_ == 0
          ? newest
          : wall_per_simulated_ + kWeightOfNewest * (newest - wall_per_simulated_);
}

}  // namespace palpate::runtime
