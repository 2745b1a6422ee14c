#include "studies/plan/course.h"

#include <algorithm>
#include <cmath>

#include "haptics/devices/device.h"
#include "modules/scene/assets.h"
#include "studies/chart/displacement_field.h"
#include "studies/rigs/pressed_organ.h"

namespace palpate::plan {
namespace {

constexpr std::size_t kMarks = 60;
constexpr double kLongestHold = 1.5;  // [s]
constexpr double kAskEvery = 0.25;    // [s]

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

std::vector<Vec3> forces_of(const rigs::PressedOrgan& pressed, std::size_t probes) {
  std::vector<Vec3> forces;
  for (std::uint32_t i = 0; i < probes; ++i) forces.push_back(pressed.force(i));
  return forces;
}

/// All but those of publishing.
void take_costs(const rigs::PressedOrgan& pressed, const scene::Rates& rates, Course& course) {
  course.time = pressed.time();
  course.volume_error = pressed.volume_error();
  course.deformation_cost = pressed.busy() / course.time;
  course.collision_cost = pressed.searching() / course.time * rates.collision / rates.deformation;
  course.haptic_tick = pressed.rendering() / course.time * pressed.period();
  course.diverged = pressed.diverged();
  course.contacts = pressed.contact_troubles();
}

double largest_force(std::span<const TrueTouch> truths) {
  double largest = 0;
  for (const TrueTouch& touch : truths) {
    for (const Vec3& force : touch.truth.forces) largest = std::max(largest, force.norm());
  }
  return largest;
}

/// Both the difference and what it is a part of are known to the bar.
void take_worse(double error, double bar, Errors& worst) {
  bar *= 1 + error;
  if (error + bar <= worst.force + worst.force_bar) return;
  worst.force = error;
  worst.force_bar = bar;
}

}  // namespace

std::vector<Vec3> marks_on(const geometry::TriangleSurface& surface) {
  std::vector<Vec3> marks;
  const std::size_t stride = std::max<std::size_t>(1, surface.triangles.size() / kMarks);
  for (std::size_t t = 0; t < surface.triangles.size(); t += stride) {
    const auto& [a, b, c] = surface.triangles[t];
    marks.push_back((surface.nodes[a] + surface.nodes[b] + surface.nodes[c]) / 3);
  }
  return marks;
}

Course run_course(const scene::Scene& scene, const geometry::OrganShape& shape,
                  const std::vector<Vec3>& marks, double duration, const std::vector<double>& held,
                  const std::function<void()>& keep_going, const WhyStop& why_stop) {
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
  double next_sample = 0, next_ask = kAskEvery;
  std::size_t next_held = 0;
  const double period = pressed.period();
  for (double time = period; time < duration + period && !pressed.diverged(); time += period) {
    keep_going();
    if (pressed.time() >= next_ask) {
      next_ask = pressed.time() + kAskEvery;
      take_costs(pressed, scene.rates, course);
      course.stopped = why_stop(course);
      if (!course.stopped.empty()) break;
    }
    for (std::size_t i = 0; i < devices.size(); ++i) poses[i] = devices[i]->read(time).pose;
    pressed.advance(poses);
    course.node_count = std::max(course.node_count, pressed.node_count());
    if (next_held < held.size() && time + period / 2 >= held[next_held]) {
      ++next_held;
      course.moving_forces.push_back(forces_of(pressed, devices.size()));
      pressed.settle(kLongestHold, keep_going);
      course.held_forces.push_back(forces_of(pressed, devices.size()));
      course.held_surfaces.push_back(marked.moved());
      next_ask = 0;
    }
    if (time + period / 2 < next_sample) continue;
    next_sample += 1 / kSampleRate;
    course.forces.push_back(forces_of(pressed, devices.size()));
    course.surfaces.push_back(marked.moved());
  }
  take_costs(pressed, scene.rates, course);
  course.publishing_cost = pressed.encoding() * scene.rates.deformation +
                           pressed.encoding_of_mesh() * pressed.changes() / pressed.time();
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

Errors compare(const Course& course, std::span<const TrueTouch> truths, std::size_t count) {
  Errors errors;
  errors.volume = course.volume_error;
  if (course.diverged || course.held_forces.size() < count) {
    errors.force = errors.surface = std::numeric_limits<double>::infinity();
    return errors;
  }
  const double light = kLight * largest_force(truths);
  double scale = 0, moved = 0, across = 0, surface = 0, surface_bars = 0;
  double ratios = 0, squared_ratios = 0;
  std::size_t touches = 0, marks = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [time, probes, truth] = truths[k];
    for (std::size_t j = 0; j < probes.size(); ++j) {
      const double expected = truth.forces[j].norm();
      if (expected == 0) continue;
      const Vec3 along = truth.forces[j] / expected;
      const Vec3 held = course.held_forces[k][probes[j]],
                 moving = course.moving_forces[k][probes[j]];
      const double found = held.dot(along), ratio = found / expected - 1;
      take_worse(std::abs(found - expected) / std::max(expected, light),
                 truth.bars[j] / std::max(expected, light), errors);
      scale += expected * expected;
      moved += std::pow(moving.dot(along) - found, 2);
      across += (moving - moving.dot(along) * along).squaredNorm();
      ratios += ratio;
      squared_ratios += ratio * ratio;
      ++touches;
    }
    for (std::size_t m = 0; m < truth.displacements.size(); ++m, ++marks) {
      surface += (course.held_surfaces[k][m] - truth.displacements[m]).squaredNorm();
      surface_bars += truth.displacement_bar * truth.displacement_bar;
    }
  }
  if (touches > 0) {
    const double n = static_cast<double>(touches), mean = ratios / n;
    errors.feel = {mean, std::sqrt(std::max(0.0, squared_ratios / n - mean * mean)),
                   std::sqrt(moved / scale), std::sqrt(across / scale)};
  }
  if (marks > 0) {
    errors.surface = std::sqrt(surface / static_cast<double>(marks));
    errors.surface_bar = std::sqrt(surface_bars / static_cast<double>(marks));
  }
  return errors;
}

}  // namespace palpate::plan
