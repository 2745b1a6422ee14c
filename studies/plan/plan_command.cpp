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
#include "studies/plan/plan_report.h"
#include "studies/plan/probe_paths.h"
#include "studies/plan/rivals.h"
#include "studies/plan/standard.h"
#include "studies/plan/verdict.h"
#include "studies/plan/verdict_store.h"
#include "studies/report/claims.h"
#include "studies/report/measures.h"
#include "studies/report/pace.h"
#include "studies/report/progress.h"

namespace palpate::plan {
namespace {

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
  if (scene.needs.contents == scene::Needs::Contents::kSolid) check_shapes(scene);
}

/// What all organs' measurements share.
struct Sharing {
  report::Claims claims;
  VerdictStore store;
  report::Share share = {};
  std::set<std::string> machines = {};  ///< that loads were measured on
};

/// What the cheapest reach spares dearer ones.
std::vector<Candidate> cheapest_first(const scene::Scene& scene, const Standard& standard) {
  auto candidates = candidates_of(scene, standard.touched(), standard.radius());
  std::ranges::stable_sort(
      candidates, {}, [&](const Candidate& each) { return weight_of(each, standard.radius()); });
  return candidates;
}

/// "3 of 94: …; about 2 min left".
std::string line_of(std::size_t i, const std::vector<Candidate>& candidates, double radius,
                    const report::Pace& pace) {
  double left = 0;
  for (std::size_t k = i; k < candidates.size(); ++k) left += weight_of(candidates[k], radius);
  return fmt::format("{} of {}: {}", i + 1, candidates.size(), candidates[i].name()) +
         report::text_of_time_left(pace.seconds_for(left));
}

/// @param scene     of one organ
/// @param one_rate  see Rivals
std::vector<Verdict> measure_all(const scene::Scene& scene, const PlanOptions& options,
                                 bool one_rate, Sharing& sharing, std::ostream& log,
                                 const std::function<void()>& keep_going) {
  Standard standard(scene, options);
  const auto candidates = cheapest_first(scene, standard);
  Rivals rivals(scene.needs, standard.truths(), one_rate);
  report::Pace pace;
  const std::string& organ = scene.organs[0].name;
  std::map<std::size_t, StoredVerdict> measured;
  const auto measure = [&](std::size_t i) {
    standard.find(log, keep_going);
    log << line_of(i, candidates, standard.radius(), pace) << std::endl;
    pace.begin();
    const auto candidate_scene = scene_with(scene, candidates[i]);
    const auto shape = scene::load_organ(candidate_scene.organs[0]);
    const Course course = run_course(
        candidate_scene, shape, standard.marks(), options.seconds, standard.held(), keep_going,
        [&](const Course& so_far) { return rivals.why_stop(candidates[i], so_far); });
    measured[i] = {judge(scene.needs, candidates[i], course, standard.errors_of(course)),
                   report::machine_name()};
    rivals.add(measured[i].verdict, course);
    pace.finish(weight_of(candidates[i], standard.radius()));
    if (!options.points.empty()) sharing.store.write(organ, measured[i]);
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

/// Of each organ that was judged by truth. What was planned is told however this ends.
/// @returns exit code
int verify(const scene::Scene& scene, const PlanOptions& options, std::vector<OrganPlan>& plans,
           std::ostream& log, const Standard::KeepGoing& keep_going) {
  const auto stopped = [&] {
    log << "stopped before all was verified" << std::endl;
    return kExitStopped;
  };
  int code = kExitDone;
  try {
    for (std::size_t i = 0; i < plans.size(); ++i) {
      OrganPlan& plan = plans[i];
      if (plan.chosen->errors.force_bar == 0) continue;
      scene::Scene alone = scene;
      alone.organs = {scene.organs[i]};
      plan.verification = verified(alone, plan.chosen->candidate, options, log, keep_going);
      if (plan.verification->instants == 0 || plan.verification->refutes(scene.needs)) {
        code = kExitFailed;
      }
    }
  } catch (const report::Stopped&) {
    return stopped();
  } catch (const Interrupted&) {  // while Gmsh filled a surface
    return stopped();
  }
  return code;
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
  if (!options.points.empty()) report::make_out_folder(options.points, "--points");
  Sharing sharing{{options.points / "claims", options.shard},
                  {options.points, told(scene, options), log}};
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
          {organ.name,
           measure_all(alone, options, scene.organs.size() > 1, sharing, log, keep_going),
           nullptr,
           {}});
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
    int code = is_met ? kExitDone : kExitFailed;
    if (options.verify && is_met) code = verify(scene, options, plans, log, keep_going);
    options.json ? print_json(scene.needs, plans, sharing.machines, file, out)
                 : print_text(scene, plans, sharing.machines, file, out);
    return code;
  } catch (const report::Stopped&) {
    log << (options.points.empty() ? "stopped; nothing was written"
                                   : "stopped; what was found stays in " + options.points.string())
        << std::endl;
    return kExitStopped;
  }
}

}  // namespace palpate::plan
