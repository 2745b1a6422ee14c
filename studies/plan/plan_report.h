// How a plan is told: to people, to programs.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "studies/plan/verdict.h"

namespace palpate::plan {

/// The choice judged by a truth that the plan did not know.
struct Verification {
  Errors errors;
  std::size_t instants = 0;  ///< that had one

  /// Whether the choice misses what is needed, by more than the truth may be off.
  bool refutes(const scene::Needs& needs) const {
    return needs.force_error && errors.force - errors.force_bar > *needs.force_error;
  }
};

/// What was measured of one organ, the cheapest first.
struct OrganPlan {
  std::string name;
  std::vector<Verdict> verdicts;
  const Verdict* chosen = nullptr;
  std::optional<Verification> verification = {};
};

/// @param machines  that loads were measured on
/// @param written   the scene file; empty: none
void print_text(const scene::Scene& scene, const std::vector<OrganPlan>& plans,
                const std::set<std::string>& machines, const std::filesystem::path& written,
                std::ostream& out);
void print_json(const scene::Needs& needs, const std::vector<OrganPlan>& plans,
                const std::set<std::string>& machines, const std::filesystem::path& written,
                std::ostream& out);

}  // namespace palpate::plan
