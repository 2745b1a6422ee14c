// What candidates of one organ are judged by: the truth at some instants, or, of a wall where there
// is none, a finer wall of the same springs.
#pragma once

#include <functional>
#include <iosfwd>
#include <vector>

#include "studies/plan/plan_command.h"
#include "studies/plan/plan_report.h"
#include "studies/plan/verdict.h"

namespace palpate::plan {

/// A truth is known under spheres and capsules, at rest. Not of a wall of which neither force nor
/// surface is asked.
bool is_judged_by_truth(const scene::Scene& scene);

class Standard {
 public:
  using KeepGoing = std::function<void()>;

  /// @param scene  of one organ
  /// @throws InputError if no probe touches what is to be judged by touches
  Standard(const scene::Scene& scene, const PlanOptions& options);

  /// Computes it, at the first call: minutes.
  /// @throws std::runtime_error if there is none; what `keep_going` throws
  void find(std::ostream& log, const KeepGoing& keep_going);

  /// Of a course that was stopped: where it was held until then, NaN if nowhere.
  Errors errors_of(const Course& course) const;
  const std::vector<TrueTouch>& truths() const { return truths_; }
  const std::vector<Vec3>& marks() const { return marks_; }
  const std::vector<double>& held() const { return held_; }  ///< where the truth is known [s]
  /// Places that probes touch, of a solid; and the radius of the smallest probe [m].
  const std::vector<scene::Region>& touched() const { return touched_; }
  double radius() const { return radius_; }

 private:
  void find_truths(std::ostream& log, const KeepGoing& keep_going);
  void run_references(std::ostream& log, const KeepGoing& keep_going);

  const scene::Scene& scene_;
  const PlanOptions& options_;
  bool is_known_ = false;
  std::vector<Vec3> marks_;
  std::vector<double> held_;
  std::vector<TrueTouch> truths_;
  std::vector<scene::Region> touched_;
  double radius_ = 0;
  Course reference_;
};

/// The choice, run anew, against a truth on finer meshes at instants between those of the plan.
/// @param scene  of one organ, judged by truth
/// @returns no instants if none has a truth @throws what `keep_going` throws
Verification verified(const scene::Scene& scene, const Candidate& chosen,
                      const PlanOptions& options, std::ostream& log,
                      const Standard::KeepGoing& keep_going);

}  // namespace palpate::plan
