#include "studies/plan/plan_command.h"

#include <json/json.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <fstream>
#include <ostream>

#include "modules/core/error.h"
#include "modules/runtime/stop_signal.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/schema.h"
#include "modules/scene/settings.h"
#include "studies/plan/plan.h"
#include "studies/plan/solid_reference.h"
#include "studies/report/measures.h"
#include "studies/report/progress.h"

namespace palpate::plan {
namespace {

void check_plannable(const scene::Scene& scene) {
  const std::string file = scene.file.string();
  if (scene.organs.size() != 1) {
    throw InputError(fmt::format("{}: key 'organs' has {} entries; a plan is made for one organ",
                                 file, scene.organs.size()));
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
  const auto extension = scene.organs[0].mesh.file.extension();
  if (extension == ".msh" || extension == ".vtk") {
    throw InputError(
        fmt::format("{}: key 'organs[0].mesh.file': a plan resamples surfaces; "
                    "tetrahedra cannot be resampled",
                    file));
  }
}

/// A force error is of a force.
void check_touched(const scene::Scene& scene, const Course& reference, double seconds) {
  if (!scene.needs.force_error) return;
  for (const auto& forces : reference.forces) {
    for (const Vec3& force : forces) {
      if (force.norm() > 0) return;
    }
  }
  throw InputError(
      fmt::format("{}: no probe touches the organ in the first {:g} s, so key 'needs.force_error' "
                  "cannot be judged; give a longer --seconds",
                  scene.file.string(), seconds));
}

void print(const std::vector<Verdict>& verdicts, const Verdict* chosen, std::ostream& out) {
  out << fmt::format("{:<42} {:>7} {:>7} {:>7} {:>11} {:>9}  {}\n", "candidate", "nodes", "load",
                     "force", "surface[mm]", "volume", "why not");
  for (const Verdict& v : verdicts) {
    std::string why = &v == chosen ? "CHOSEN" : fmt::format("{}", fmt::join(v.failures, "; "));
    if (why.empty()) {
      why = fmt::format("{:.2f} times the load of the choice", v.total_load / chosen->total_load);
    }
    out << fmt::format("{:<42} {:>7} {:>6.1f}% {:>6.1f}% {:>11.3g} {:>9.1e}  {}\n",
                       v.candidate.name(), v.node_count, 100 * v.total_load, 100 * v.errors.force,
                       1e3 * v.errors.surface, v.errors.volume, why);
  }
}

void print_margins(const scene::Needs& needs, const Verdict& v, std::ostream& out) {
  out << "\nchosen: " << v.candidate.name() << "\nmargins:";
  const auto margin = [&](const char* what, const std::optional<double>& need, double value) {
    if (need) out << fmt::format(" {} {:.2g} of {:.2g} allowed;", what, value, *need);
  };
  margin("force error", needs.force_error, v.errors.force);
  margin("surface error [m]", needs.surface_error, v.errors.surface);
  margin("volume error", needs.volume_error, v.errors.volume);
  out << fmt::format(" load {:.2f} of {:.2f} cores\n", v.total_load,
                     kLargestLoad * static_cast<double>(needs.cores));
}

/// @param written  the scene file; empty: none
void print_json(const std::vector<Verdict>& verdicts, const Verdict* chosen,
                const std::filesystem::path& written, std::ostream& out) {
  Json::Value value;
  value["machine"] = report::machine_name();
  value["candidates"] = Json::arrayValue;
  for (const Verdict& v : verdicts) {
    Json::Value row;
    row["name"] = v.candidate.name();
    row["nodes"] = Json::UInt64(v.node_count);
    row["load_cores"] = v.total_load;
    row["force_error"] = v.errors.force;
    row["surface_error_m"] = v.errors.surface;
    row["volume_error"] = v.errors.volume;
    row["chosen"] = &v == chosen;
    row["misses"] = Json::arrayValue;
    for (const auto& failure : v.failures) row["misses"].append(failure);
    value["candidates"].append(row);
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

/// @param coarser  of a wall half the nodes; of a solid, whose edges are refined by halving, edges
///                 twice as long where the probes go
Course run_reference(const scene::Scene& scene, bool coarser, const std::vector<Vec3>& marks,
                     double duration, const std::function<void()>& keep_going) {
  auto candidate = reference_of(scene);
  const bool solid = scene.needs.contents == scene::Needs::Contents::kSolid;
  if (coarser && !solid) candidate.nodes /= 2;
  const auto reference_scene = scene_with(scene, candidate);
  const auto shape =
      solid ? solid_reference_shape(reference_scene, duration, (coarser ? 2 : 1) * kReferenceEdge)
            : scene::load_organ(reference_scene.organs[0]);
  return run_course(reference_scene, shape, marks, duration, keep_going);
}

/// @param written  the scene file; empty: none
void print_text(const scene::Needs& needs, const std::vector<Verdict>& verdicts,
                const Verdict* chosen, const std::filesystem::path& written, std::ostream& out) {
  print(verdicts, chosen, out);
  out << "load: of one core; force: RMS difference from the reference over its RMS; on "
      << report::machine_name() << '\n';
  if (chosen == nullptr) {
    out << "\nnothing meets the needs. What would:\n";
    for (const auto& way : ways_out(needs, verdicts)) out << "  " << way << '\n';
    return;
  }
  print_margins(needs, *chosen, out);
  out << "written: " << written.string() << '\n';
}

/// How far the reference may be off: candidates that differ less from it are not told apart.
void print_reference(const Course& reference, const Course& coarser, std::ostream& log) {
  const Errors errors = compare(coarser, reference);
  log << fmt::format(
             "reference: {} nodes; a coarser one of {} differs by {:.1f}% of the force, {:.2g} mm "
             "of "
             "surface",
             reference.node_count, coarser.node_count, 100 * errors.force, 1e3 * errors.surface)
      << std::endl;
}

std::vector<Verdict> measure_all(const scene::Scene& scene, const PlanOptions& options,
                                 std::ostream& log, const std::function<void()>& keep_going) {
  log << "reference: " << reference_of(scene).name() << ", and a coarser one" << std::endl;
  const auto marks = marks_on(scene::load_organ(scene.organs[0]).surface);
  const Course reference = run_reference(scene, false, marks, options.seconds, keep_going);
  if (reference.diverged) throw std::runtime_error("the reference diverged on this scene: no plan");
  if (reference.contacts.truncated + reference.contacts.lost > 0) {
    throw std::runtime_error("contacts of the reference were left out on this scene: no plan");
  }
  check_touched(scene, reference, options.seconds);
  const Course coarser = run_reference(scene, true, marks, options.seconds, keep_going);
  print_reference(reference, coarser, log);
  std::vector<Verdict> verdicts;
  const auto candidates = candidates_of(scene);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    log << fmt::format("{} of {}: {}", i + 1, candidates.size(), candidates[i].name()) << std::endl;
    const auto candidate_scene = scene_with(scene, candidates[i]);
    const auto shape = scene::load_organ(candidate_scene.organs[0]);
    const Course course = run_course(candidate_scene, shape, marks, options.seconds, keep_going);
    verdicts.push_back(judge(scene.needs, candidates[i], course, reference));
  }
  std::stable_sort(verdicts.begin(), verdicts.end(),
                   [](const Verdict& a, const Verdict& b) { return a.total_load < b.total_load; });
  return verdicts;
}

}  // namespace

int run_plan(const PlanOptions& options, std::ostream& out, std::ostream& log) {
  const scene::Scene scene = scene::load_scene_with(options.scene, options.settings);
  check_plannable(scene);
  const runtime::StopSignal stop;
  try {
    const auto verdicts = measure_all(scene, options, log, [&] {
      if (stop.requested()) throw report::Stopped{};
    });
    const Verdict* chosen = best(verdicts);
    std::filesystem::path file;
    if (chosen != nullptr) {
      file = options.out;
      if (file.empty()) {
        file = scene.file.parent_path() / (scene.file.stem().string() + ".planned.yaml");
      }
      write_scene(scene_with(scene, chosen->candidate), file);
    }
    options.json ? print_json(verdicts, chosen, file, out)
                 : print_text(scene.needs, verdicts, chosen, file, out);
    return chosen == nullptr ? kExitFailed : kExitDone;
  } catch (const report::Stopped&) {
    log << "stopped; nothing was written" << std::endl;
    return report::kExitStopped;
  }
}

}  // namespace palpate::plan
