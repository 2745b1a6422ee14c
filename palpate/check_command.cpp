#include "palpate/check_command.h"

#include <json/json.h>
#include <spdlog/fmt/fmt.h>

#include <ostream>

#include "modules/core/error.h"
#include "modules/scene/processes.h"
#include "modules/scene/scene_file.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/schema.h"
#include "modules/scene/settings.h"
#include "palpate/scene_check.h"
#include "palpate/scene_doubts.h"
#include "palpate/session/contact_line.h"

namespace palpate::launcher {
namespace {

std::string verdict(const SceneCheck& check) {
  const double share = 100 * check.cost / check.period;
  const std::size_t processes = scene::process_count(check.scene);
  std::string text = fmt::format("{}: can be run", check.scene.file.string());
  if (!check.doubts.empty()) {
    text +=
        fmt::format(", with {} doubt{}", check.doubts.size(), check.doubts.size() == 1 ? "" : "s");
  }
  text += check.cost <= check.period ? "; in real time here" : "; slower than real time here";
  text += fmt::format(
      ": deformation takes {:.3f} ms of each {:.3f} ms, lightly touched ({:.0f} % of one core), "
      "real-time factor {:.2f}{}\n",
      1e3 * check.cost, 1e3 * check.period, share, check.real_time_factor(),
      processes == 1 ? "" : fmt::format("; here in one process, in a run {} share it", processes));
  if (check.mesh_changes > 0) {
    text += fmt::format("  its mesh follows the touch: {:.0f} changes a second in that\n",
                        check.mesh_changes);
  }
  if (check.cost > check.period) {
    text += "  as fast as the machine allows, and right: palpate run --lockstep\n";
  }
  return text;
}

std::string poisson_text(const OrganCheck& organ) {
  if (organ.computed_poisson_ratio == organ.asked_poisson_ratio) {
    return fmt::format("{:g}", organ.asked_poisson_ratio);
  }
  return fmt::format("{:g}, computed with {:.3f}", organ.asked_poisson_ratio,
                     organ.computed_poisson_ratio);
}

std::string joined_by(const OrganCheck& organ) {
  if (organ.tetrahedra == 0) {
    return fmt::format("springs: {} structural, {} bending, {} inner", organ.structural,
                       organ.bending, organ.inner);
  }
  return fmt::format("{} {} tetrahedra, Poisson's ratio {}", organ.tetrahedra,
                     organ.quadratic ? "quadratic" : "linear", poisson_text(organ));
}

std::string steps_text(const OrganCheck& organ, double period) {
  std::string text =
      fmt::format("{}: {} sub-steps of {:.1f} us (largest {:.1f} us)", organ.model, organ.substeps,
                  1e6 * period / organ.substeps, 1e6 * organ.largest_step);
  if (!organ.integrator) return text;
  return text + fmt::format(
                    "; {} ({}), passes over the springs per simulated second: symplectic_euler "
                    "{:.0f}, backward_euler {:.0f}",
                    scene::word_of(organ.integrator->integrator),
                    organ.integrator_automatic ? "automatic" : "by the scene",
                    organ.integrator->symplectic_passes, organ.integrator->backward_passes);
}

std::string organ_text(const OrganCheck& organ, double period) {
  return fmt::format(
             "organ {}: {:.0f} x {:.0f} x {:.0f} mm, {:.1f} cm3, {:.3f} kg; {} surface + {} {} "
             "nodes, {} fixed, {} triangles\n",
             organ.name, 1e3 * organ.size.x(), 1e3 * organ.size.y(), 1e3 * organ.size.z(),
             1e6 * organ.volume, organ.mass, organ.surface_nodes, organ.inner_nodes,
             organ.tetrahedra > 0 ? "inner" : "virtual", organ.fixed_nodes, organ.triangles) +
         fmt::format("  {}\n  {}\n", joined_by(organ), steps_text(organ, period));
}

std::string probe_text(const ProbeCheck& probe) {
  const collision::Approach& approach = probe.motion.approach;
  std::string text = fmt::format("probe {}: {}, {}", probe.name, probe.shape, probe.device);
  if (const auto& recording = probe.motion.recording) {
    text +=
        fmt::format(" of {} poses, {:.6g} s, {:.3g} x {:.3g} x {:.3g} mm, fastest {:.3g} m/s",
                    recording->poses, recording->duration, 1e3 * recording->extent.x(),
                    1e3 * recording->extent.y(), 1e3 * recording->extent.z(), recording->fastest);
  }
  if (approach.begins_inside) return text + "; begins inside an organ\n";
  if (approach.touches_at) text += fmt::format("; touches first at {:.2f} s", *approach.touches_at);
  if (approach.fastest > 0) text += fmt::format("; up to {:.3g} m/s", approach.fastest);
  return text + '\n';
}

void print_text(const SceneCheck& check, std::ostream& out) {
  out << verdict(check);
  for (const auto& doubt : check.doubts) out << "warning: " << doubt << '\n';
  for (const auto& organ : check.organs) out << organ_text(organ, check.period);
  for (const auto& probe : check.probes) out << probe_text(probe);
  const scene::Rates& rates = check.scene.rates;
  out << fmt::format(
      "rates: haptics {:g} Hz, collision {:g} Hz, deformation {:g} Hz, visualizer {:g} Hz\n",
      rates.haptics, rates.collision, rates.deformation, rates.visualizer);
  const ContactTroubles& troubles = check.troubles;
  if (troubles.truncated + troubles.lost + troubles.unsolved > 0) {
    out << session::contact_line(troubles) << '\n';
  }
}

Json::Value json_of(const OrganCheck& organ) {
  Json::Value value;
  value["name"] = organ.name;
  value["model"] = organ.model;
  for (const double side : organ.size) value["size_m"].append(side);
  value["volume_m3"] = organ.volume;
  value["mass_kg"] = organ.mass;
  value["surface_nodes"] = Json::UInt64(organ.surface_nodes);
  value["inner_nodes"] = Json::UInt64(organ.inner_nodes);
  value["fixed_nodes"] = Json::UInt64(organ.fixed_nodes);
  value["triangles"] = Json::UInt64(organ.triangles);
  value["tetrahedra"] = Json::UInt64(organ.tetrahedra);
  value["springs"] = Json::UInt64(organ.structural + organ.bending + organ.inner);
  value["largest_step_s"] = organ.largest_step;
  value["substeps"] = organ.substeps;
  return value;
}

Json::Value json_of(const ProbeCheck& probe) {
  Json::Value value;
  value["name"] = probe.name;
  value["shape"] = probe.shape;
  value["device"] = probe.device;
  value["begins_inside"] = probe.motion.approach.begins_inside;
  if (probe.motion.approach.touches_at) value["touches_at_s"] = *probe.motion.approach.touches_at;
  value["fastest_m_per_s"] = probe.motion.approach.fastest;
  if (const auto& recording = probe.motion.recording) {
    Json::Value& told = value["recording"];
    told["poses"] = Json::UInt64(recording->poses);
    told["duration_s"] = recording->duration;
    for (const double side : recording->extent) told["extent_m"].append(side);
    told["fastest_m_per_s"] = recording->fastest;
  }
  return value;
}

void print_json(const SceneCheck& check, std::ostream& out) {
  Json::Value value;
  value["scene"] = check.scene.file.string();
  value["real_time"] = check.cost <= check.period;
  value["real_time_factor"] = check.real_time_factor();
  value["deformation_period_s"] = check.period;
  value["deformation_cost_s"] = check.cost;
  value["warnings"] = Json::arrayValue;
  for (const auto& doubt : check.doubts) value["warnings"].append(doubt);
  for (const auto& organ : check.organs) value["organs"].append(json_of(organ));
  for (const auto& probe : check.probes) value["probes"].append(json_of(probe));
  out << Json::writeString(Json::StreamWriterBuilder(), value) << '\n';
}

}  // namespace

int check_command(const CheckOptions& options, std::ostream& out, std::ostream& log) {
  const scene::Scene scene =
      scene::load_scene_with(scene::scene_file(options.scene), options.settings);
  if (options.resolved) {
    out << scene::resolved_text(scene);
    return kExitDone;
  }
  const SceneCheck check =
      check_scene(scene, options.measure_for, progress_on(log), resampling_on(log));
  options.json ? print_json(check, out) : print_text(check, out);
  return kExitDone;
}

}  // namespace palpate::launcher
