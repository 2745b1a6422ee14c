#include "studies/plan/verdict.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "deformation/models.h"

namespace palpate::plan {
namespace {

void check(const char* what, const std::optional<double>& need, double value,
           std::vector<std::string>& failures) {
  if (!need || value <= *need) return;
  failures.push_back(fmt::format("{} {:.3g} > {:.3g}", what, value, *need));
}

/// Of an error that is known to ± `bar`.
void check(const char* what, const std::optional<double>& need, double value, double bar,
           std::vector<std::string>& failures) {
  if (!need || value + bar <= *need) return;
  failures.push_back(bar > 0 ? fmt::format("{} {:.3g} ± {:.1g} > {:.3g}", what, value, bar, *need)
                             : fmt::format("{} {:.3g} > {:.3g}", what, value, *need));
}

}  // namespace

double total_load(const scene::Needs& needs, const Course& course) {
  return course.deformation_cost + course.collision_cost + course.publishing_cost +
         needs.haptics_rate * course.haptic_tick;
}

Verdict judge(const scene::Needs& needs, const Candidate& candidate, const Course& course,
              const Errors& errors) {
  Verdict verdict;
  verdict.candidate = candidate;
  verdict.errors = errors;
  verdict.node_count = course.node_count;
  verdict.deformation_load = course.deformation_cost;
  verdict.total_load = total_load(needs, course);
  verdict.is_cut = !course.stopped.empty();
  if (verdict.is_cut) {
    verdict.failures.push_back(course.stopped);
    return verdict;
  }
  check("force error", needs.force_error, errors.force, errors.force_bar, verdict.failures);
  check("surface error [m]", needs.surface_error, errors.surface, errors.surface_bar,
        verdict.failures);
  check("volume error", needs.volume_error, errors.volume, verdict.failures);
  check("load of the core of deformation", kLargestLoad, verdict.deformation_load,
        verdict.failures);
  check("load of all cores", kLargestLoad * static_cast<double>(needs.cores), verdict.total_load,
        verdict.failures);
  if (course.diverged) verdict.failures.emplace_back("diverged");
  if (course.contacts.truncated + course.contacts.lost > 0) {
    verdict.failures.emplace_back("contacts left out");
  }
  return verdict;
}

const Verdict* best(const std::vector<Verdict>& verdicts, std::optional<double> rate) {
  const auto qualifies = [&](const Verdict& v) {
    return v.failures.empty() && (!rate || v.candidate.rate == *rate);
  };
  double least = std::numeric_limits<double>::infinity();
  for (const Verdict& v : verdicts) {
    if (qualifies(v)) least = std::min(least, v.total_load);
  }
  const auto rank = [](const Verdict& v) {
    return std::tuple(v.node_count, deformation::row_of(v.candidate.model).step_cost,
                      v.candidate.rate, v.total_load);
  };
  const Verdict* found = nullptr;
  for (const Verdict& v : verdicts) {
    if (!qualifies(v) || v.total_load > (1 + kLoadNoise) * least) continue;
    if (found == nullptr || rank(v) < rank(*found)) found = &v;
  }
  return found;
}

std::vector<std::string> ways_out(const scene::Needs& needs, const std::vector<Verdict>& verdicts) {
  const auto fits = [&](const Verdict& v) {
    return v.deformation_load <= kLargestLoad &&
           v.total_load <= kLargestLoad * static_cast<double>(needs.cores);
  };
  std::vector<std::string> ways;
  const Verdict *most_accurate = nullptr, *fastest = nullptr;
  for (const Verdict& v : verdicts) {
    if (v.is_cut) continue;
    const bool accurate =
        v.errors.force + v.errors.force_bar <= needs.force_error.value_or(1e9) &&
        v.errors.surface + v.errors.surface_bar <= needs.surface_error.value_or(1e9) &&
        v.errors.volume <= needs.volume_error.value_or(1e9);
    if (accurate && (fastest == nullptr || v.total_load < fastest->total_load)) fastest = &v;
    if (fits(v) && (most_accurate == nullptr || v.errors.force < most_accurate->errors.force)) {
      most_accurate = &v;
    }
  }
  if (fastest != nullptr) {
    const double factor =
        std::max(fastest->deformation_load / kLargestLoad,
                 fastest->total_load / (kLargestLoad * static_cast<double>(needs.cores)));
    ways.push_back(
        fmt::format("cores {:.2g} times as fast: {}", factor, fastest->candidate.name()));
  }
  if (most_accurate != nullptr) {
    ways.push_back(
        fmt::format("force_error {:.2g}, surface_error_m {:.2g}, volume_error {:.2g}: {}",
                    most_accurate->errors.force + most_accurate->errors.force_bar,
                    most_accurate->errors.surface + most_accurate->errors.surface_bar,
                    most_accurate->errors.volume, most_accurate->candidate.name()));
  }
  return ways;
}

}  // namespace palpate::plan
