#include "studies/plan/plan.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>

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
constexpr double kReferenceRate = 500;  // [Hz]
constexpr double kLongestHold = 1.5;    // [s]

/// Longest edge at a touched place in radii, and its growth with the distance.
struct Rung {
  double edge, growth;
};
constexpr std::array kLinear{Rung{1, 1}, Rung{0.5, 0.7}, Rung{0.5, 0.5}, Rung{1.0 / 3, 0.35}};
constexpr std::array kQuadratic{Rung{1.4, 1}, Rung{1, 1}, Rung{0.7, 1}};

/// None: a model that is not refined where it is touched.
std::span<const Rung> rungs_of(const std::string& model) {
  if (model == "nodal_pressure") return kLinear;
  if (model == "quadratic_pressure") return kQuadratic;
  return {};
}

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

/// Marks on a surface whose mesh may change.
class Marks {
 public:
  /// @param marks  stay where they are
  Marks(const rigs::PressedOrgan& pressed, const std::vector<Vec3>& marks)
      : pressed_(pressed), marks_(marks) {}

  /// Displacements: surfaces of other meshes lie a little aside.
  std::vector<Vec3> moved() {
    if (generation_ != pressed_.generation()) {
      generation_ = pressed_.generation();
      weights_ = find_marks(pressed_.skin(), marks_);
    }
    std::vector<Vec3> displacements;
    for (const auto& weights : weights_) {
      Vec3& sum = displacements.emplace_back(Vec3::Zero());
      for (const auto& [node, weight] : weights) {
        sum += weight * (pressed_.position(node) - pressed_.rest_position(node));
      }
    }
    return displacements;
  }

 private:
  const rigs::PressedOrgan& pressed_;
  const std::vector<Vec3>& marks_;
  std::uint32_t generation_ = 0;  // meshes begin at 1
  std::vector<chart::NodeWeights> weights_;
};

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

/// Of an error that is known to ± `bar`.
void check(const char* what, const std::optional<double>& need, double value, double bar,
           std::vector<std::string>& failures) {
  if (!need || value + bar <= *need) return;
  failures.push_back(bar > 0 ? fmt::format("{} {:.3g} ± {:.1g} > {:.3g}", what, value, bar, *need)
                             : fmt::format("{} {:.3g} > {:.3g}", what, value, *need));
}

std::vector<Vec3> forces_of(const rigs::PressedOrgan& pressed, std::size_t probes) {
  std::vector<Vec3> forces;
  for (std::uint32_t i = 0; i < probes; ++i) forces.push_back(pressed.force(i));
  return forces;
}

}  // namespace

std::string Candidate::name() const {
  auto text =
      fmt::format("{}, {} nodes, {:g} Hz{}", model, nodes, rate,
                  integrator == scene::Integrator::kBackwardEuler ? ", backward_euler" : "");
  if (refine.any()) {
    text += fmt::format(", {:.3g} mm + {:.2g} d",
                        1e3 * refine.edge_length.value_or(scene::Refinement::kRegionEdge),
                        refine.growth.value_or(scene::Refinement::kGrowth));
  }
  if (refine.follow) text += " following";
  return text;
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
  return {"implicit_volume", std::min(4 * nodes_of(scene), kMostNodes), kReferenceRate,
          scene::Integrator::kSymplecticEuler};
}

std::vector<Candidate> candidates_of(const scene::Scene& scene,
                                     const std::vector<scene::Region>& touched, double radius) {
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
      if (touched.empty() || count > nodes || count < kLeastNodes) continue;
      for (const auto& [edge, growth] : rungs_of(model)) {
        constexpr auto kIntegrator = scene::Integrator::kAutomatic;
        candidates.push_back({model, count, least, kIntegrator, {touched, edge * radius, growth}});
        candidates.push_back({model, count, least, kIntegrator, {{}, edge * radius, growth, true}});
      }
    }
  }
  return candidates;
}

scene::Scene scene_with(const scene::Scene& scene, const Candidate& candidate, std::size_t number) {
  scene::Scene changed = scene;
  scene::Organ& organ = changed.organs[number];
  organ.model = candidate.model;
  organ.integrator = candidate.integrator;
  organ.iterations = 0;
  scene::drop_ignored_keys(organ);
  organ.solid.poisson_ratio =
      chart::unlocked_poisson_ratio(candidate.model, organ.solid.poisson_ratio);
  organ.mesh.nodes = candidate.nodes;
  organ.solid.refine = candidate.refine;
  if (candidate.rate > 0) changed.rates.deformation = candidate.rate;
  changed.rates.collision = std::max(changed.rates.collision, changed.rates.deformation);
  changed.rates.haptics = std::max(changed.rates.haptics, changed.needs.haptics_rate);
  return changed;
}

Course run_course(const scene::Scene& scene, const geometry::OrganShape& shape,
                  const std::vector<Vec3>& marks, double duration, const std::vector<double>& held,
                  const std::function<void()>& keep_going) {
  std::vector<std::unique_ptr<haptics::Device>> devices;
  std::vector<Pose> poses;
  std::vector<std::string> warnings;
  for (const auto& probe : scene.probes) {
    devices.push_back(haptics::make_device(probe.device, scene.haptics, warnings));
    poses.push_back(devices.back()->read(0).pose);
  }
  rigs::PressedOrgan pressed(scene, shape, poses);
  Marks marked(pressed, marks);
  Course course;
  double next_sample = 0;
  std::size_t next_held = 0;
  const double period = pressed.period();
  for (double time = period; time < duration + period && !pressed.diverged(); time += period) {
    keep_going();
    for (std::size_t i = 0; i < devices.size(); ++i) poses[i] = devices[i]->read(time).pose;
    pressed.advance(poses);
    course.node_count = std::max(course.node_count, pressed.node_count());
    if (next_held < held.size() && time + period / 2 >= held[next_held]) {
      ++next_held;
      course.moving_forces.push_back(forces_of(pressed, devices.size()));
      pressed.settle(kLongestHold);
      course.held_forces.push_back(forces_of(pressed, devices.size()));
      course.held_surfaces.push_back(marked.moved());
    }
    if (time + period / 2 < next_sample) continue;
    next_sample += 1 / kSampleRate;
    course.forces.push_back(forces_of(pressed, devices.size()));
    course.surfaces.push_back(marked.moved());
  }
  course.volume_error = pressed.volume_error();
  course.deformation_cost = pressed.busy() / pressed.time();
  const auto& rates = scene.rates;
  course.collision_cost =
      pressed.searching() / pressed.time() * rates.collision / rates.deformation;
  course.publishing_cost = pressed.encoding() * rates.deformation +
                           pressed.encoding_of_mesh() * pressed.changes() / pressed.time();
  course.haptic_tick = pressed.rendering() / pressed.time() * period;
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

Errors compare(const Course& course, const std::vector<TrueTouch>& truths) {
  Errors errors;
  errors.volume = course.volume_error;
  if (course.diverged || course.held_forces.size() < truths.size()) {
    errors.force = errors.surface = std::numeric_limits<double>::infinity();
    return errors;
  }
  double off = 0, scale = 0, bars = 0, moved = 0, across = 0, surface = 0, surface_bars = 0;
  double ratios = 0, squared_ratios = 0;
  std::size_t count = 0, marks = 0;
  for (std::size_t k = 0; k < truths.size(); ++k) {
    const auto& [time, probes, truth] = truths[k];
    for (std::size_t j = 0; j < probes.size(); ++j) {
      const double expected = truth.forces[j].norm();
      if (expected == 0) continue;
      const Vec3 along = truth.forces[j] / expected;
      const Vec3 held = course.held_forces[k][probes[j]],
                 moving = course.moving_forces[k][probes[j]];
      const double found = held.dot(along), ratio = found / expected - 1;
      off += (found - expected) * (found - expected);
      scale += expected * expected;
      bars += truth.bars[j] * truth.bars[j];
      moved += std::pow(moving.dot(along) - found, 2);
      across += (moving - moving.dot(along) * along).squaredNorm();
      ratios += ratio;
      squared_ratios += ratio * ratio;
      ++count;
    }
    for (std::size_t m = 0; m < truth.displacements.size(); ++m, ++marks) {
      surface += (course.held_surfaces[k][m] - truth.displacements[m]).squaredNorm();
      surface_bars += truth.displacement_bar * truth.displacement_bar;
    }
  }
  if (count > 0) {
    const double n = static_cast<double>(count), mean = ratios / n;
    errors.force = std::sqrt(off / scale);
    // Both the difference and what it is a part of are known to the bar.
    errors.force_bar = std::sqrt(bars / scale) * (1 + errors.force);
    errors.feel = {mean, std::sqrt(std::max(0.0, squared_ratios / n - mean * mean)),
                   std::sqrt(moved / scale), std::sqrt(across / scale)};
  }
  if (marks > 0) {
    errors.surface = std::sqrt(surface / static_cast<double>(marks));
    errors.surface_bar = std::sqrt(surface_bars / static_cast<double>(marks));
  }
  return errors;
}

Verdict judge(const scene::Needs& needs, const Candidate& candidate, const Course& course,
              const Errors& errors) {
  Verdict verdict;
  verdict.candidate = candidate;
  verdict.errors = errors;
  verdict.node_count = course.node_count;
  verdict.deformation_load = course.deformation_cost;
  verdict.total_load = course.deformation_cost + course.collision_cost + course.publishing_cost +
                       needs.haptics_rate * course.haptic_tick;
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
