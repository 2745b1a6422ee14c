// How much simulated time a cycle takes on, so that it ends within its period.
#pragma once

namespace palpate::runtime {

/// A simulation that keeps up takes one period per cycle. One that cannot takes less per cycle
/// instead of fewer cycles: simulated time falls behind by the same factor, but what it publishes
/// stays as fresh as the period.
class CycleBudget {
 public:
  /// @param period  of a cycle [s]   @param least  smallest useful amount, one sub-step [s]
  CycleBudget(double period, double least) : period_(period), least_(least) {}

  /// Simulated time of the next cycle [s], between `least` and one period.
  double next() const;
  /// The last cycle simulated `simulated` in `wall` [s].
  void took(double simulated, double wall);

 private:
  double period_, least_;
  double wall_per_simulated_ = 0;  ///< smoothed over about ten cycles; 0 before the first
};

}  // namespace palpate::runtime
