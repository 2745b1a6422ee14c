#include "studies/plan/rivals.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace palpate::plan {
namespace {

/// Over kLargestLoad. What a short piece shows is a part of it too much, where something else meets
/// the needs; else it is to be known which faster core it would want, unless there will be none.
constexpr double kTooSlow = 1.5, kFarTooSlow = 4;
constexpr std::size_t kEnoughInstants = 2;
/// Loads over that of one which meets all needs.
constexpr double kDear = 2;

}  // namespace

void Rivals::add(const Verdict& verdict, const Course& course) {
  if (verdict.is_cut || course.diverged) return;
  Rival rival{verdict.candidate.name(),
              verdict.candidate.rate,
              verdict.total_load,
              verdict.failures.empty(),
              {}};
  for (std::size_t k = 1; k <= truths_.size(); ++k) {
    rival.errors.push_back(compare(course, truths_, k));
  }
  rivals_.push_back(std::move(rival));
}

std::string Rivals::why_too_slow(const Course& so_far) const {
  const double load = so_far.deformation_cost / kLargestLoad;
  const bool any = std::ranges::any_of(rivals_, &Rival::meets_all);
  if (load <= (any ? kTooSlow : kFarTooSlow)) return {};
  return fmt::format("load of the core of deformation {:.3g} > {:.3g} in its first {:.2g} s",
                     so_far.deformation_cost, kLargestLoad, so_far.time);
}

/// If all that is still to come were right.
bool Rivals::misses_for_sure(const Errors& so_far, std::size_t instants) const {
  const double of_marks = std::sqrt(double(instants) / double(truths_.size()));
  return (needs_.force_error && so_far.force > *needs_.force_error) ||
         (needs_.surface_error && so_far.surface * of_marks > *needs_.surface_error) ||
         (needs_.volume_error && so_far.volume > *needs_.volume_error);
}

std::string Rivals::why_stop(const Candidate& candidate, const Course& so_far) const {
  const std::string slow = why_too_slow(so_far);
  const std::size_t k = so_far.held_forces.size(), all = truths_.size();
  if (!slow.empty() || k >= all || 2 * k < std::min(2 * kEnoughInstants, all)) return slow;
  const Errors errors = compare(so_far, truths_, k);
  const bool misses = misses_for_sure(errors, k);
  const double load = total_load(needs_, so_far);
  for (const Rival& rival : rivals_) {
    if ((one_rate_ && rival.rate != candidate.rate) || load <= (1 + kLoadNoise) * rival.load) {
      continue;
    }
    const Errors& other = rival.errors[k - 1];
    const bool is_worse =
        needs_.force_error ? errors.force >= other.force : errors.surface >= other.surface;
    if (rival.meets_all && load > kDear * rival.load) {
      return fmt::format("by {} of {} instants {:.2g} times the load of {}, which meets all", k,
                         all, load / rival.load, rival.name);
    }
    if (is_worse && (rival.meets_all || misses)) {
      return fmt::format("by {} of {} instants more load and more error than {}", k, all,
                         rival.name);
    }
  }
  return {};
}

}  // namespace palpate::plan
