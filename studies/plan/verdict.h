// What is to be said of a candidate, and which one is chosen: the cheapest model, mesh and step
// that meet what a scene needs, measured on that scene and this machine.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/plan/candidates.h"
#include "studies/plan/course.h"

namespace palpate::plan {

struct Verdict {
  Candidate candidate;
  Errors errors;
  double deformation_load = 0;  ///< of one core, at the candidate's rate
  double total_load = 0;        ///< of all cores wanted: deformation, collision, bytes, haptics
  std::size_t node_count = 0;
  std::vector<std::string> failures;  ///< needs it does not meet, in words; empty: it meets all
  /// It was not run to its end: errors are of the instants until then, NaN if there were none, and
  /// `failures` says why.
  bool is_cut = false;
};

/// A load above this leaves no room for a slower moment.
inline constexpr double kLargestLoad = 0.8;
/// Loads that differ by less are equal: as far as two runs of one candidate differ.
inline constexpr double kLoadNoise = 0.1;

/// Of all cores wanted.
double total_load(const scene::Needs& needs, const Course& course);

Verdict judge(const scene::Needs& needs, const Candidate& candidate, const Course& course,
              const Errors& errors);

/// Of those that meet all needs and load little more than the least (kLoadNoise): the one of the
/// fewest nodes, then of the cheaper model, then of the lower rate.
/// @param rate  of deformation [Hz], if only candidates of that rate are asked for
const Verdict* best(const std::vector<Verdict>& verdicts, std::optional<double> rate = {});

/// What would have to be given up or gained so that something meets the needs; one line per way,
/// from candidates that fail one need only.
std::vector<std::string> ways_out(const scene::Needs& needs, const std::vector<Verdict>& verdicts);

}  // namespace palpate::plan
