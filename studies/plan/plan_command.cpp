#include "studies/plan/plan_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <set>
#include <thread>
#include <utility>

#include "modules/core/error.h"
#include "modules/core/output_file.h"
#include "modules/core/stop_signal.h"
#include "modules/core/whole_file.h"
#include "modules/runtime/program.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/assets.h"
#include "modules/scene/processes.h"
#include "modules/scene/scene_file.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/schema.h"
#include "modules/scene/settings.h"
#include "studies/plan/plan.h"
#include "studies/plan/plan_report.h"
#include "studies/plan/probe_paths.h"
#include "studies/plan/verdict_store.h"
#include "studies/report/claims.h"
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

/// Where probes touch a solid.
void find_places(const scene::Scene& scene, const PlanOptions& options, Standard& standard) {
  const ProbePaths paths(scene, scene::load_skin(scene.organs[0]), options.seconds);
  if (paths.touching(options.touches).empty()) throw untouched(scene, options.seconds);
  standard.touched = paths.regions();
  standard.radius = paths.smallest_radius();
}

/// Equilibria of quadratic elements.
/// @param fineness  see truth::Effort
std::vector<TrueTouch> truths_at(const scene::Scene& scene, const ProbePaths& paths,
                                 const std::vector<double>& times, const std::vector<Vec3>& marks,
                                 double fineness, const std::function<void()>& keep_going) {
  const auto body = truth::body_of(scene.organs[0]);
  std::vector<std::optional<TrueTouch>> found(times.size());
  runtime::WorkerTeam team(std::clamp(std::thread::hardware_concurrency(), 1u, 4u));
  truth::run_all(team, times.size(), [&](std::size_t i) {
    TrueTouch touch{times[i], {}, {}};
    auto question = paths.question_at(times[i], touch.probes);
    question.marks = marks;
    const auto truths = truth::force_truth(body, question, {nullptr, fineness, keep_going});
    if (truths.empty()) return;
    touch.truth = truths[0];
    found[i] = touch;
  });
  std::vector<TrueTouch> truths;
  for (const auto& touch : found) {
    if (touch) truths.push_back(*touch);
  }
  return truths;
}

/// At some of the poses in which probes touch.
void find_truths(const scene::Scene& scene, const PlanOptions& options, std::ostream& log,
                 const std::function<void()>& keep_going, Standard& standard) {
  const ProbePaths paths(scene, scene::load_skin(scene.organs[0]), options.seconds);
  const auto times = paths.touching(options.touches);
  log << fmt::format("truth: equilibria of quadratic elements at {} instants", times.size())
      << std::endl;
  standard.truths = truths_at(scene, paths, times, standard.marks, 1, keep_going);
  for (const TrueTouch& touch : standard.truths) {
    standard.held.push_back(touch.time);
    log << fmt::format("  {:.2f} s:", touch.time);
    for (std::size_t j = 0; j < touch.probes.size(); ++j) {
      log << fmt::format(" {:.4g} ± {:.2g} N", touch.truth.forces[j].norm(), touch.truth.bars[j]);
    }
    log << fmt::format(", {} nodes", touch.truth.node_count) << std::endl;
  }
  if (standard.truths.empty()) {
    throw std::runtime_error("no equilibrium was found where probes touch: no plan");
  }
  if (standard.truths.size() < times.size()) {
    log << fmt::format("  none found at {} more", times.size() - standard.truths.size())
        << std::endl;
  }
}

/// The choice, run anew, against a truth on finer meshes at instants between those of the plan.
/// @param scene  of one organ
Verification verified(const scene::Scene& scene, const Candidate& chosen,
                      const PlanOptions& options, const std::function<void()>& keep_going) {
  constexpr double kFiner = 0.75;  // edges over those of the plan's truth
  const ProbePaths paths(scene, scene::load_skin(scene.organs[0]), options.seconds);
  const auto planned = paths.touching(options.touches);
  std::vector<double> times;
  for (const double time : paths.touching(2 * options.touches + 1)) {
    if (std::ranges::find(planned, time) == planned.end()) times.push_back(time);
  }
  const auto truths = truths_at(scene, paths, times, {}, kFiner, keep_going);
  if (truths.empty()) throw std::runtime_error("no equilibrium was found to verify by");
  times.clear();
  for (const TrueTouch& touch : truths) times.push_back(touch.time);
  const auto changed = scene_with(scene, chosen);
  const Course course = run_course(changed, scene::load_organ(changed.organs[0]), {},
                                   options.seconds, times, keep_going);
  return {compare(course, truths), times.size()};
}

/// What all organs' measurements share.
struct Sharing {
  report::Claims claims;
  VerdictStore store;
  report::Share share = {};
  std::set<std::string> machines = {};  ///< that loads were measured on
};

/// @param scene  of one organ
std::vector<Verdict> measure_all(const scene::Scene& scene, const PlanOptions& options,
                                 Sharing& sharing, std::ostream& log,
                                 const std::function<void()>& keep_going) {
  Standard standard;
  standard.marks = marks_on(scene::load_organ(scene.organs[0]).surface);
  if (is_solid(scene)) find_places(scene, options, standard);
  const auto candidates = candidates_of(scene, standard.touched, standard.radius);
  const std::string& organ = scene.organs[0].name;
  bool is_known = false;
  std::map<std::size_t, StoredVerdict> measured;
  const auto measure = [&](std::size_t i) {
    if (!std::exchange(is_known, true)) {
      (is_solid(scene) ? find_truths : run_references)(scene, options, log, keep_going, standard);
    }
    log << fmt::format("{} of {}: {}", i + 1, candidates.size(), candidates[i].name()) << std::endl;
    const auto candidate_scene = scene_with(scene, candidates[i]);
    const auto shape = scene::load_organ(candidate_scene.organs[0]);
    const Course course = run_course(candidate_scene, shape, standard.marks, options.seconds,
                                     standard.held, keep_going);
    measured[i] = {judge(scene.needs, candidates[i], course, standard.errors_of(course)),
                   report::machine_name()};
    if (options.shard) sharing.store.write(organ, measured[i]);
  };
  std::vector<Verdict> verdicts;
  std::vector<report::Point> points;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto read = [&, i] {
      StoredVerdict stored;
      if (measured.contains(i)) {
        stored = measured.at(i);
      } else if (!sharing.store.read(organ, candidates[i], stored)) {
        return false;
      }
      sharing.machines.insert(stored.machine);
      verdicts.push_back(stored.verdict);
      return true;
    };
    points.push_back({sharing.store.key(organ, candidates[i]), read, [&, i] { measure(i); }});
  }
  sharing.share += report::measure_points(points, sharing.claims);
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

/// Beside the scene, of a shipped one here, unless it is named; then a file that is there is some
/// scene, perhaps one written by hand.
/// @throws InputError before the work if it cannot be written
std::filesystem::path output_of(const scene::Scene& scene, const PlanOptions& options) {
  std::filesystem::path file = options.out;
  if (file.empty()) {
    file = scene.file.stem().string() + ".planned.yaml";
    if (!scene::is_shipped(scene.file)) file = scene.file.parent_path() / file;
  } else if (std::filesystem::exists(file)) {
    throw InputError(file.string() + ": is there already; --out names another");
  }
  check_writable(file);
  return file;
}

/// What verdicts depend on.
std::string told(const scene::Scene& scene, const PlanOptions& options) {
  std::string text = fmt::format("{} {} for {} s, {} touches", runtime::version_text(),
                                 scene::scene_digest(scene), options.seconds, options.touches);
  for (const auto& organ : scene.organs) {
    for (const Vec3& node : scene::load_skin(organ).nodes) {
      text += fmt::format(" {} {} {}", node.x(), node.y(), node.z());
    }
  }
  return fmt::format("{:016x}", std::hash<std::string>{}(text));
}

}  // namespace

int run_plan(const PlanOptions& options, std::ostream& out, std::ostream& log) {
  const scene::Scene scene = scene::in_one_process(
      scene::load_scene_with(scene::scene_file(options.scene), options.settings));
  check_plannable(scene);
  if (options.shard && options.points.empty()) {
    throw InputError("--shard needs --points, the folder that all shards share");
  }
  const std::filesystem::path output = options.shard ? "" : output_of(scene, options);
  Sharing sharing{{options.points / "claims", options.shard},
                  {options.points, told(scene, options)}};
  const StopSignal stop;
  const auto keep_going = [&] {
    if (stop.requested()) throw report::Stopped{};
    sharing.claims.keep();
  };
  try {
    std::vector<OrganPlan> plans;
    for (const auto& organ : scene.organs) {
      scene::Scene alone = scene;
      alone.organs = {organ};
      if (scene.organs.size() > 1) log << "organ '" << organ.name << "'" << std::endl;
      plans.push_back(
          {organ.name, measure_all(alone, options, sharing, log, keep_going), nullptr, {}});
    }
    if (options.shard) {
      out << report::text_of(sharing.share, *options.shard);
      return kExitDone;
    }
    const bool is_met = choose(scene.needs, plans);
    std::filesystem::path file;
    if (is_met) {
      file = output;
      scene::Scene planned = scene;
      for (std::size_t i = 0; i < plans.size(); ++i) {
        planned = scene_with(planned, plans[i].chosen->candidate, i);
      }
      write_whole_file(file, scene::resolved_text(planned));
    }
    for (std::size_t i = 0; options.verify && is_met && is_solid(scene) && i < plans.size(); ++i) {
      scene::Scene alone = scene;
      alone.organs = {scene.organs[i]};
      log << "verifying: a finer truth, at other instants" << std::endl;
      plans[i].verification = verified(alone, plans[i].chosen->candidate, options, keep_going);
    }
    options.json ? print_json(plans, sharing.machines, file, out)
                 : print_text(scene, plans, sharing.machines, file, out);
    return is_met ? kExitDone : kExitFailed;
  } catch (const report::Stopped&) {
    log << "stopped; nothing was written" << std::endl;
    return kExitStopped;
  }
}

}  // namespace palpate::plan
