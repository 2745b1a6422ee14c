#include "studies/plan/plan_command.h"

#include <json/json.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <ostream>
#include <set>
#include <thread>

#include "modules/core/error.h"
#include "modules/runtime/stop_signal.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/schema.h"
#include "modules/scene/settings.h"
#include "studies/plan/plan.h"
#include "studies/plan/probe_paths.h"
#include "studies/report/measures.h"
#include "studies/report/progress.h"

namespace palpate::plan {
namespace {

bool is_solid(const scene::Scene& scene) {
  return scene.needs.contents == scene::Needs::Contents::kSolid;
}

void check_plannable(const scene::Scene& scene) {
  const std::string file = scene.file.string();
  if (scene.organs.size() > 1 && scene.contacts.any()) {
    throw InputError(
        fmt::format("{}: key 'contacts': a plan is made organ by organ, as if they did "
                    "not touch each other",
                    file));
  }
  const auto& needs = scene.needs;
  if (!needs.force_error && !needs.surface_error && !needs.volume_error) {
    throw InputError(fmt::format(
        "{}: key 'needs' asks for nothing; give force_error, surface_error_m or volume_error",
        file));
  }
  for (std::size_t i = 0; i < scene.probes.size(); ++i) {
    if (!std::holds_alternative<scene::EmulatedDevice>(scene.probes[i].device)) continue;
    throw InputError(
        fmt::format("{}: key 'probes[{}].device': a plan compares models under the same "
                    "motion; 'emulated' yields to the force",
                    file, i));
  }
  for (std::size_t i = 0; i < scene.organs.size(); ++i) {
    const auto extension = scene.organs[i].mesh.file.extension();
    if (extension != ".msh" && extension != ".vtk") continue;
    throw InputError(
        fmt::format("{}: key 'organs[{}].mesh.file': a plan resamples surfaces; "
                    "tetrahedra cannot be resampled",
                    file, i));
  }
  if (is_solid(scene)) check_shapes(scene);
}

InputError untouched(const scene::Scene& scene, double seconds) {
  return InputError(
      fmt::format("{}: no probe touches the organ in the first {:g} s, so key 'needs.force_error' "
                  "cannot be judged; give a longer --seconds",
                  scene.file.string(), seconds));
}

/// A force error is of a force.
void check_touched(const scene::Scene& scene, const Course& reference, double seconds) {
  if (!scene.needs.force_error) return;
  for (const auto& forces : reference.forces) {
    for (const Vec3& force : forces) {
      if (force.norm() > 0) return;
    }
  }
  throw untouched(scene, seconds);
}

/// "12.3 ± 2.1%", or of what has no bar "12.3%".
std::string percent(double part, double bar) {
  if (!std::isfinite(part)) return "diverged";
  return bar > 0 ? fmt::format("{:.1f} ± {:.1f}%", 100 * part, 100 * bar)
                 : fmt::format("{:.1f}%", 100 * part);
}

std::string text_of(const Feel& feel) {
  return fmt::format("{:.0f}% too {}, uneven by {:.0f}%, in motion {:.0f}%, sideways {:.0f}%",
                     100 * std::abs(feel.stiffness), feel.stiffness > 0 ? "hard" : "soft",
                     100 * feel.uneven, 100 * feel.moving, 100 * feel.sideways);
}

/// What was measured of one organ, the cheapest first.
struct OrganPlan {
  std::string name;
  std::vector<Verdict> verdicts;
  const Verdict* chosen = nullptr;
};

/// Of a candidate that meets all needs.
std::string why_not(const Verdict& verdict, const Verdict* chosen) {
  if (chosen == nullptr) return "with the others too much for the cores";
  const double ratio = verdict.total_load / chosen->total_load;
  return ratio <= 1 + kLoadNoise ? "as good: its load is the choice's, but for noise"
                                 : fmt::format("{:.2f} times the load of the choice", ratio);
}

void print(const OrganPlan& plan, bool solid, std::ostream& out) {
  out << fmt::format("{:<58} {:>7} {:>7} {:>14} {:>11} {:>9}  {}\n", "candidate", "nodes", "load",
                     "force", "surface[mm]", "volume", "why not");
  for (const Verdict& v : plan.verdicts) {
    std::string why = &v == plan.chosen ? "CHOSEN" : fmt::format("{}", fmt::join(v.failures, "; "));
    if (why.empty()) why = why_not(v, plan.chosen);
    out << fmt::format("{:<58} {:>7} {:>6.1f}% {:>14} {:>11.3g} {:>9.1e}  {}\n", v.candidate.name(),
                       v.node_count, 100 * v.total_load,
                       percent(v.errors.force, v.errors.force_bar), 1e3 * v.errors.surface,
                       v.errors.volume, why);
    if (solid && std::isfinite(v.errors.force)) {
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

/// @param written  the scene file; empty: none
void print_json(const std::vector<OrganPlan>& plans, const std::filesystem::path& written,
                std::ostream& out) {
  Json::Value value;
  value["machine"] = report::machine_name();
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
      row["chosen"] = &v == plan.chosen;
      row["misses"] = Json::arrayValue;
      for (const auto& failure : v.failures) row["misses"].append(failure);
      value["candidates"].append(row);
    }
  }
  if (!written.empty()) value["written"] = written.string();
  out << Json::writeString(Json::StreamWriterBuilder(), value) << '\n';
}

void write_scene(const scene::Scene& scene, const std::filesystem::path& file) {
  const auto part = file.string() + ".part";
  std::ofstream stream(part);
  stream << scene::resolved_text(scene);
  stream.flush();
  if (!stream) throw std::runtime_error(part + ": cannot be written");
  std::filesystem::rename(part, file);
}

/// @param written  the scene file; empty: none
void print_text(const scene::Scene& scene, const std::vector<OrganPlan>& plans,
                const std::filesystem::path& written, std::ostream& out) {
  for (const OrganPlan& plan : plans) {
    if (plans.size() > 1) out << "\norgan '" << plan.name << "'\n";
    print(plan, is_solid(scene), out);
  }
  out << "load: of one core; force: RMS difference from the "
      << (is_solid(scene) ? "truth, along it, over its RMS, and how far that may be off; on "
                          : "reference over its RMS; on ")
      << report::machine_name() << '\n';
  if (written.empty()) {
    out << "\nnothing meets the needs. What would:\n";
    for (const OrganPlan& plan : plans) {
      for (const auto& way : ways_out(scene.needs, plan.verdicts)) out << "  " << way << '\n';
    }
    return;
  }
  for (const OrganPlan& plan : plans) {
    print_margins(scene.needs, *plan.chosen, out);
    if (is_solid(scene))
      out << "the hand would feel: " << text_of(plan.chosen->errors.feel) << '\n';
  }
  out << "written: " << written.string() << '\n';
}

/// What candidates of one organ are judged by.
struct Standard {
  std::vector<Vec3> marks;
  std::vector<double> held;       ///< of a solid: where its truth is known [s]
  std::vector<TrueTouch> truths;  ///< of a solid
  std::vector<scene::Region> touched;
  double radius = 0;  ///< of the smallest probe [m]
  Course reference;   ///< of a wall

  Errors errors_of(const Course& course) const {
    return truths.empty() ? compare(course, reference) : compare(course, truths);
  }
};

/// Of springs on four times the nodes, and on twice, which say how far those may be off.
void run_references(const scene::Scene& scene, const PlanOptions& options, std::ostream& log,
                    const std::function<void()>& keep_going, Standard& standard) {
  const auto run = [&](std::size_t part) {
    auto candidate = reference_of(scene);
    candidate.nodes /= part;
    const auto changed = scene_with(scene, candidate);
    return run_course(changed, scene::load_organ(changed.organs[0]), standard.marks,
                      options.seconds, {}, keep_going);
  };
  log << "reference: " << reference_of(scene).name() << ", and a coarser one" << std::endl;
  standard.reference = run(1);
  const Course& reference = standard.reference;
  if (reference.diverged) throw std::runtime_error("the reference diverged on this scene: no plan");
  if (reference.contacts.truncated + reference.contacts.lost > 0) {
    throw std::runtime_error("contacts of the reference were left out on this scene: no plan");
  }
  check_touched(scene, reference, options.seconds);
  const Course coarser = run(2);
  const Errors errors = compare(coarser, reference);
  log << fmt::format(
             "reference: {} nodes; a coarser one of {} differs by {:.1f}% of the force, {:.2g} mm "
             "of "
             "surface",
             reference.node_count, coarser.node_count, 100 * errors.force, 1e3 * errors.surface)
      << std::endl;
}

/// Equilibria of quadratic elements at some of the poses in which probes touch.
void find_truths(const scene::Scene& scene, const PlanOptions& options, std::ostream& log,
                 const std::function<void()>& keep_going, Standard& standard) {
  const ProbePaths paths(scene, scene::load_skin(scene.organs[0]), options.seconds);
  const auto times = paths.touching(options.touches);
  if (times.empty()) throw untouched(scene, options.seconds);
  standard.touched = paths.regions();
  standard.radius = paths.smallest_radius();
  log << fmt::format("truth: equilibria of quadratic elements at {} instants", times.size())
      << std::endl;
  const auto body = truth::body_of(scene.organs[0]);
  std::vector<std::optional<TrueTouch>> found(times.size());
  runtime::WorkerTeam team(std::clamp(std::thread::hardware_concurrency(), 1u, 4u));
  truth::run_all(team, times.size(), [&](std::size_t i) {
    TrueTouch touch{times[i], {}, {}};
    auto question = paths.question_at(times[i], touch.probes);
    question.marks = standard.marks;
    const auto truths = truth::force_truth(body, question, {nullptr, 1, keep_going});
    if (truths.empty()) return;
    touch.truth = truths[0];
    found[i] = touch;
  });
  for (const auto& touch : found) {
    if (!touch) continue;
    standard.held.push_back(touch->time);
    standard.truths.push_back(*touch);
    log << fmt::format("  {:.2f} s:", touch->time);
    for (std::size_t j = 0; j < touch->probes.size(); ++j) {
      log << fmt::format(" {:.4g} ± {:.2g} N", touch->truth.forces[j].norm(), touch->truth.bars[j]);
    }
    log << fmt::format(", {} nodes", touch->truth.node_count) << std::endl;
  }
  if (standard.truths.empty()) {
    throw std::runtime_error("no equilibrium was found where probes touch: no plan");
  }
  if (standard.truths.size() < times.size()) {
    log << fmt::format("  none found at {} more", times.size() - standard.truths.size())
        << std::endl;
  }
}

/// @param scene  of one organ
std::vector<Verdict> measure_all(const scene::Scene& scene, const PlanOptions& options,
                                 std::ostream& log, const std::function<void()>& keep_going) {
  Standard standard;
  standard.marks = marks_on(scene::load_organ(scene.organs[0]).surface);
  (is_solid(scene) ? find_truths : run_references)(scene, options, log, keep_going, standard);
  std::vector<Verdict> verdicts;
  const auto candidates = candidates_of(scene, standard.touched, standard.radius);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    log << fmt::format("{} of {}: {}", i + 1, candidates.size(), candidates[i].name()) << std::endl;
    const auto candidate_scene = scene_with(scene, candidates[i]);
    const auto shape = scene::load_organ(candidate_scene.organs[0]);
    const Course course = run_course(candidate_scene, shape, standard.marks, options.seconds,
                                     standard.held, keep_going);
    verdicts.push_back(judge(scene.needs, candidates[i], course, standard.errors_of(course)));
  }
  std::stable_sort(verdicts.begin(), verdicts.end(),
                   [](const Verdict& a, const Verdict& b) { return a.total_load < b.total_load; });
  return verdicts;
}

/// One candidate for each organ, all at one rate, whose loads together are least.
/// @returns false if there is none
bool choose(const scene::Needs& needs, std::vector<OrganPlan>& plans) {
  if (plans.size() == 1) return (plans[0].chosen = best(plans[0].verdicts)) != nullptr;
  std::set<double> rates;
  for (const Verdict& v : plans[0].verdicts) rates.insert(v.candidate.rate);
  double least = kLargestLoad * static_cast<double>(needs.cores);
  for (const double rate : rates) {
    std::vector<const Verdict*> chosen;
    double load = 0;
    for (const OrganPlan& plan : plans) {
      chosen.push_back(best(plan.verdicts, rate));
      load += chosen.back() ? chosen.back()->total_load : least;
    }
    if (load >= least) continue;
    least = load;
    for (std::size_t i = 0; i < plans.size(); ++i) plans[i].chosen = chosen[i];
  }
  return plans[0].chosen != nullptr;
}

}  // namespace

int run_plan(const PlanOptions& options, std::ostream& out, std::ostream& log) {
  const scene::Scene scene = scene::load_scene_with(options.scene, options.settings);
  check_plannable(scene);
  const runtime::StopSignal stop;
  const auto keep_going = [&] {
    if (stop.requested()) throw report::Stopped{};
  };
  try {
    std::vector<OrganPlan> plans;
    for (const auto& organ : scene.organs) {
      scene::Scene alone = scene;
      alone.organs = {organ};
      if (scene.organs.size() > 1) log << "organ '" << organ.name << "'" << std::endl;
      plans.push_back({organ.name, measure_all(alone, options, log, keep_going), nullptr});
    }
    const bool is_met = choose(scene.needs, plans);
    std::filesystem::path file;
    if (is_met) {
      file = options.out;
      if (file.empty()) {
        file = scene.file.parent_path() / (scene.file.stem().string() + ".planned.yaml");
      }
      scene::Scene planned = scene;
      for (std::size_t i = 0; i < plans.size(); ++i) {
        planned = scene_with(planned, plans[i].chosen->candidate, i);
      }
      write_scene(planned, file);
    }
    options.json ? print_json(plans, file, out) : print_text(scene, plans, file, out);
    return is_met ? kExitDone : kExitFailed;
  } catch (const report::Stopped&) {
    log << "stopped; nothing was written" << std::endl;
    return report::kExitStopped;
  }
}

}  // namespace palpate::plan
