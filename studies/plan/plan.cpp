#include "studies/plan/plan.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "deformation/models.h"
#include "haptics/devices/device.h"
#include "modules/scene/assets.h"
#include "modules/scene/models.h"
#include "modules/scene/schema.h"
#include "studies/chart/displacement_field.h"
#include "studies/chart/fidelity.h"
#include "studies/rigs/pressed_organ.h"

namespace palpate::plan {
namespace {

constexpr std::size_t kMarks = 60;
constexpr std::size_t kLeastNodes = 60, kMostNodes = 20000;
constexpr double kReferenceRateOfFluid = 500, kReferenceRateOfSolid = 200;  // [Hz]

std::vector<std::string> models_for(scene::Needs::Contents contents) {
  const bool fluid = contents == scene::Needs::Contents::kFluid;
  std::vector<std::string> models;
  for (const deformation::ModelRow& row : deformation::model_rows()) {
    if (fluid ? row.stands_for_fluid : row.stands_for_solid) models.emplace_back(row.word);
  }
  return models;
}

std::size_t nodes_of(const scene::Scene& scene) {
  return scene::load_organ(
             scene_with(scene, {"implicit_volume", scene.organs[0].mesh.nodes, 100}).organs[0])
      .surface.nodes.size();
}

/// Where the marks are on this mesh.
std::vector<chart::NodeWeights> find_marks(const geometry::OrganShape& shape,
                                           const std::vector<Vec3>& marks) {
  std::vector<chart::NodeWeights> found;
  found.reserve(marks.size());
  constexpr double kAnyDistance = 1;  // [m]: the nearest point of this surface stands for it
  for (const Vec3& mark : marks) found.push_back(chart::weights_at(shape, mark, kAnyDistance));
  return found;
}

/// The marks' displacements: surfaces of other meshes lie a little aside.
std::vector<Vec3> marked(const rigs::PressedOrgan& pressed,
                         const std::vector<chart::NodeWeights>& marks) {
  std::vector<Vec3> displacements;
  for (const auto& weights : marks) {
    Vec3& sum = displacements.emplace_back(Vec3::Zero());
    for (const auto& [node, weight] : weights) {
      sum += weight * (pressed.position(node) - pressed.rest_position(node));
    }
  }
  return displacements;
}

/// √ mean of the squared lengths of what `difference` gives for each entry.
template <class Difference>
double root_mean_square(const std::vector<std::vector<Vec3>>& a, Difference difference) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < a[i].size(); ++k, ++count) sum += difference(i, k).squaredNorm();
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

void check(const char* what, const std::optional<double>& need, double value,
           std::vector<std::string>& failures) {
  if (!need || value <= *need) return;
  failures.push_back(fmt::format("{} {:.3g} > {:.3g}", what, value, *need));
}

}  // namespace

std::string Candidate::name() const {
  return fmt::format("{}, {} nodes, {:g} Hz{}", model, nodes, rate,
                     integrator == scene::Integrator::kBackwardEuler ? ", backward_euler" : "");
}

std::vector<Vec3> marks_on(const geometry::TriangleSurface& surface) {
  std::vector<Vec3> marks;
  const std::size_t stride = std::max<std::size_t>(1, surface.triangles.size() / kMarks);
  for (std::size_t t = 0; t < surface.triangles.size(); t += stride) {
    const auto& [a, b, c] = surface.triangles[t];
    marks.push_back((surface.nodes[a] + surface.nodes[b] + surface.nodes[c]) / 3);
  }
  return marks;
}

Candidate reference_of(const scene::Scene& scene) {
  const std::size_t nodes = nodes_of(scene);
  if (scene.needs.contents == scene::Needs::Contents::kSolid) {
    return {"nodal_pressure", nodes, kReferenceRateOfSolid};
  }
  return {"implicit_volume", std::min(4 * nodes, kMostNodes), kReferenceRateOfFluid,
          scene::Integrator::kSymplecticEuler};
}

std::vector<Candidate> candidates_of(const scene::Scene& scene) {
  const std::size_t nodes = nodes_of(scene);
  const double least = scene.needs.step_rate;
  std::vector<Candidate> candidates;
  for (const std::string& model : models_for(scene.needs.contents)) {
    for (std::size_t count : {nodes / 4, nodes / 2, nodes, 2 * nodes}) {
      // Of a quadratic mesh these are corners: a quarter of them makes as many nodes.
      if (scene::is_quadratic(model)) count /= 4;
      for (const double rate : {least, 2 * least}) {
        if (count < kLeastNodes || count > kMostNodes || rate > 2000) continue;
        candidates.push_back({model, count, rate});
      }
    }
  }
  return candidates;
}

scene::Scene scene_with(const scene::Scene& scene, const Candidate& candidate) {
  scene::Scene changed = scene;
  scene::Organ& organ = changed.organs[0];
  organ.model = candidate.model;
  organ.integrator = candidate.integrator;
  organ.iterations = 0;
  scene::drop_ignored_keys(organ);
  organ.solid.poisson_ratio =
      chart::unlocked_poisson_ratio(candidate.model, organ.solid.poisson_ratio);
  organ.mesh.nodes = candidate.nodes;
  if (candidate.rate > 0) changed.rates.deformation = candidate.rate;
  changed.rates.collision = std::max(changed.rates.collision, changed.rates.deformation);
  changed.rates.haptics = std::max(changed.rates.haptics, changed.needs.haptics_rate);
  return changed;
}

Course run_course(const scene::Scene& scene, const geometry::OrganShape& shape,
                  const std::vector<Vec3>& marks, double duration,
                  const std::function<void()>& keep_going) {
  std::vector<std::unique_ptr<haptics::Device>> devices;
  std::vector<Pose> poses;
  std::vector<std::string> warnings;
  for (const auto& probe : scene.probes) {
    devices.push_back(haptics::make_device(probe.device, scene.haptics, warnings));
    poses.push_back(devices.back()->read(0).pose);
  }
  rigs::PressedOrgan pressed(scene, shape, poses);
  const auto places = find_marks(shape, marks);
  Course course;
  course.node_count = shape.node_count();
  double next_sample = 0;
  while (pressed.time() < duration && !pressed.diverged()) {
    keep_going();
    const double time = pressed.time() + pressed.period();
    for (std::size_t i = 0; i < devices.size(); ++i) poses[i] = devices[i]->read(time).pose;
    pressed.advance(poses);
    if (pressed.time() + pressed.period() / 2 < next_sample) continue;
    next_sample += 1 / kSampleRate;
    auto& forces = course.forces.emplace_back();
    for (std::uint32_t i = 0; i < devices.size(); ++i) forces.push_back(pressed.force(i));
    course.surfaces.push_back(marked(pressed, places));
  }
  course.volume_error = pressed.volume_error();
  course.deformation_cost = pressed.busy() / pressed.time();
  course.collision_cost = pressed.searching() / pressed.time();
  course.diverged = pressed.diverged();
  course.contacts = pressed.contact_troubles();
  return course;
}

Errors compare(const Course& course, const Course& reference) {
  Errors errors;
  errors.volume = course.volume_error;
  if (course.diverged || course.forces.size() < reference.forces.size()) {
    errors.force = errors.surface = std::numeric_limits<double>::infinity();
    return errors;
  }
  const double scale = root_mean_square(
      reference.forces, [&](std::size_t i, std::size_t k) { return reference.forces[i][k]; });
  const double off = root_mean_square(reference.forces, [&](std::size_t i, std::size_t k) -> Vec3 {
    return course.forces[i][k] - reference.forces[i][k];
  });
  errors.force = scale > 0 ? off / scale : 0;
  errors.surface = root_mean_square(reference.surfaces, [&](std::size_t i, std::size_t k) -> Vec3 {
    return course.surfaces[i][k] - reference.surfaces[i][k];
  });
  return errors;
}

Verdict judge(const scene::Needs& needs, const Candidate& candidate, const Course& course,
              const Course& reference) {
  Verdict verdict;
  verdict.candidate = candidate;
  verdict.errors = compare(course, reference);
  verdict.node_count = course.node_count;
  verdict.deformation_load = course.deformation_cost;
  verdict.total_load =
      course.deformation_cost + course.collision_cost + needs.haptics_rate * kHapticTick;
  check("force error", needs.force_error, verdict.errors.force, verdict.failures);
  check("surface error [m]", needs.surface_error, verdict.errors.surface, verdict.failures);
  check("volume error", needs.volume_error, verdict.errors.volume, verdict.failures);
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

const Verdict* best(const std::vector<Verdict>& verdicts) {
  const Verdict* found = nullptr;
  for (const Verdict& verdict : verdicts) {
    if (!verdict.failures.empty()) continue;
    if (found == nullptr || verdict.total_load < found->total_load) found = &verdict;
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
    const bool accurate = v.errors.force <= needs.force_error.value_or(1e9) &&
                          v.errors.surface <= needs.surface_error.value_or(1e9) &&
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
                    most_accurate->errors.force, most_accurate->errors.surface,
                    most_accurate->errors.volume, most_accurate->candidate.name()));
  }
  return ways;
}

}  // namespace palpate::plan
