#include "studies/plan/plan_report.h"

#include <json/json.h>
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace palpate::plan {
namespace {

std::string machines_text(const std::set<std::string>& machines) {
  return fmt::format("{}", fmt::join(machines, "; "));
}

/// "12.3 ± 2.1%", or of what has no bar "12.3%".
std::string percent(double part, double bar) {
  if (std::isnan(part)) return "–";
  if (!std::isfinite(part)) return "diverged";
  return bar > 0 ? fmt::format("{:.1f} ± {:.1f}%", 100 * part, 100 * bar)
                 : fmt::format("{:.1f}%", 100 * part);
}

/// "–" of a candidate that was dropped before anything was to compare, as of its force.
std::string millimetres(double metres) {
  return std::isnan(metres) ? "–" : fmt::format("{:.3g}", 1e3 * metres);
}

std::string text_of(const Feel& feel) {
  return fmt::format("{:.0f}% too {}, uneven by {:.0f}%, in motion {:.0f}%, sideways {:.0f}%",
                     100 * std::abs(feel.stiffness), feel.stiffness > 0 ? "hard" : "soft",
                     100 * feel.uneven, 100 * feel.moving, 100 * feel.sideways);
}

/// Of a candidate that meets all needs.
std::string why_not(const Verdict& verdict, const Verdict* chosen) {
  if (chosen == nullptr) return "with the others too much for the cores";
  const double ratio = verdict.total_load / chosen->total_load;
  return ratio <= 1 + kLoadNoise ? "as good: its load is the choice's, but for noise"
                                 : fmt::format("{:.2f} times the load of the choice", ratio);
}

void print(const OrganPlan& plan, bool by_truth, std::ostream& out) {
  out << fmt::format("{:<62} {:>7} {:>7} {:>14} {:>11} {:>9}  {}\n", "candidate", "nodes", "load",
                     "force", "surface[mm]", "volume", "why not");
  for (const Verdict& v : plan.verdicts) {
    std::string why = &v == plan.chosen ? "CHOSEN" : fmt::format("{}", fmt::join(v.failures, "; "));
    if (why.empty()) why = why_not(v, plan.chosen);
    out << fmt::format("{:<62} {:>7} {:>6.1f}% {:>14} {:>11} {:>9.1e}  {}\n", v.candidate.name(),
                       v.node_count, 100 * v.total_load,
                       percent(v.errors.force, v.errors.force_bar), millimetres(v.errors.surface),
                       v.errors.volume, why);
    if (by_truth && std::isfinite(v.errors.force)) {
      out << "    " << text_of(v.errors.feel) << '\n';
    }
  }
}

void print_margins(const scene::Needs& needs, const Verdict& v, std::ostream& out) {
  out << "\nchosen: " << v.candidate.name() << "\nmargins:";
  const auto margin = [&](const char* what, const std::optional<double>& need, double value,
                          double bar) {
    if (!need) return;
    out << fmt::format(" {} {:.2g}{} of {:.2g} allowed;", what, value,
                       bar > 0 ? fmt::format(" ± {:.1g}", bar) : "", *need);
  };
  margin("force error", needs.force_error, v.errors.force, v.errors.force_bar);
  margin("surface error [m]", needs.surface_error, v.errors.surface, v.errors.surface_bar);
  margin("volume error", needs.volume_error, v.errors.volume, 0);
  out << fmt::format(" load {:.2f} of {:.2f} cores\n", v.total_load,
                     kLargestLoad * static_cast<double>(needs.cores));
}

}  // namespace

void print_json(const scene::Needs& needs, const std::vector<OrganPlan>& plans,
                const std::set<std::string>& machines, const std::filesystem::path& written,
                std::ostream& out) {
  Json::Value value;
  value["machine"] = machines_text(machines);
  value["candidates"] = Json::arrayValue;
  for (const OrganPlan& plan : plans) {
    for (const Verdict& v : plan.verdicts) {
      Json::Value row;
      row["organ"] = plan.name;
      row["name"] = v.candidate.name();
      row["nodes"] = Json::UInt64(v.node_count);
      row["load_cores"] = v.total_load;
      row["force_error"] = v.errors.force;
      row["force_error_bar"] = v.errors.force_bar;
      row["surface_error_m"] = v.errors.surface;
      row["surface_error_bar_m"] = v.errors.surface_bar;
      row["volume_error"] = v.errors.volume;
      row["feel"]["too_hard"] = v.errors.feel.stiffness;
      row["feel"]["uneven"] = v.errors.feel.uneven;
      row["feel"]["in_motion"] = v.errors.feel.moving;
      row["feel"]["sideways"] = v.errors.feel.sideways;
      row["run_to_its_end"] = !v.is_cut;
      row["chosen"] = &v == plan.chosen;
      row["misses"] = Json::arrayValue;
      for (const auto& failure : v.failures) row["misses"].append(failure);
      value["candidates"].append(row);
    }
  }
  for (const OrganPlan& plan : plans) {
    if (!plan.verification) continue;
    Json::Value row;
    row["organ"] = plan.name;
    row["instants"] = Json::UInt64(plan.verification->instants);
    if (plan.verification->instants > 0) {
      row["force_error"] = plan.verification->errors.force;
      row["force_error_bar"] = plan.verification->errors.force_bar;
      row["refuted"] = plan.verification->refutes(needs);
    }
    value["verified"].append(row);
  }
  if (!written.empty()) value["written"] = written.string();
  out << Json::writeString(Json::StreamWriterBuilder(), value) << '\n';
}

void print_text(const scene::Scene& scene, const std::vector<OrganPlan>& plans,
                const std::set<std::string>& machines, const std::filesystem::path& written,
                std::ostream& out) {
  const bool by_truth = std::ranges::any_of(plans, [](const OrganPlan& plan) {
    return std::ranges::any_of(plan.verdicts,
                               [](const Verdict& v) { return v.errors.force_bar > 0; });
  });
  for (const OrganPlan& plan : plans) {
    if (plans.size() > 1) out << "\norgan '" << plan.name << "'\n";
    print(plan, by_truth, out);
  }
  out << "load: of one core; force: "
      << (by_truth ? "largest difference from the truth, along it, over the true force there (or a "
                     "fifth of the largest), and how far that may be off; on "
                   : "RMS difference from the reference over its RMS; on ")
      << machines_text(machines) << '\n';
  if (written.empty()) {
    out << "\nnothing meets the needs. What would:\n";
    for (const OrganPlan& plan : plans) {
      for (const auto& way : ways_out(scene.needs, plan.verdicts)) out << "  " << way << '\n';
    }
    return;
  }
  for (const OrganPlan& plan : plans) {
    print_margins(scene.needs, *plan.chosen, out);
    if (!by_truth) continue;
    out << "the hand would feel: " << text_of(plan.chosen->errors.feel) << '\n';
    if (plan.verification && plan.verification->instants == 0) {
      out << "not verified: on finer meshes no equilibrium was found at any other instant\n";
    } else if (plan.verification) {
      const Errors& found = plan.verification->errors;
      out << fmt::format("{} by a finer truth at {} other instants: force {}",
                         plan.verification->refutes(scene.needs) ? "refuted" : "verified",
                         plan.verification->instants, percent(found.force, found.force_bar));
      if (scene.needs.force_error) {
        out << fmt::format(" of {:.2g}% allowed", 100 * *scene.needs.force_error);
      }
      out << '\n';
    }
  }
  out << "written: " << written.string() << '\n';
}

}  // namespace palpate::plan
