// How a plan is told: to people, to programs.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <set>
#include <string>
#include <vector>

#include "studies/plan/plan.h"

namespace palpate::plan {

/// What was measured of one organ, the cheapest first.
struct OrganPlan {
  std::string name;
  std::vector<Verdict> verdicts;
  const Verdict* chosen = nullptr;
};

/// @param machines  that loads were measured on
/// @param written   the scene file; empty: none
void print_text(const scene::Scene& scene, const std::vector<OrganPlan>& plans,
                const std::set<std::string>& machines, const std::filesystem::path& written,
                std::ostream& out);
void print_json(const std::vector<OrganPlan>& plans, const std::set<std::string>& machines,
                const std::filesystem::path& written, std::ostream& out);

}  // namespace palpate::plan
