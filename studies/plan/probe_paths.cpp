#include "studies/plan/probe_paths.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/devices/device.h"
#include "modules/core/error.h"
#include "modules/scene/touched_places.h"

namespace palpate::plan {
namespace {

constexpr double kLeastDepth = 0.05;  // radii, of what counts as touching

geometry::RoundedSegment moved(const geometry::RoundedSegment& probe, const Vec3& by) {
  return {probe.a + by, probe.b + by, probe.radius};
}

bool has_known_shape(const scene::Probe& probe) {
  return std::holds_alternative<geometry::RoundedSegment>(scene::form_of(probe.shape));
}

}  // namespace

std::vector<double> spread(const std::vector<double>& times, std::size_t count) {
  if (times.size() <= count) return times;
  std::vector<double> chosen;
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(times[(2 * i + 1) * times.size() / (2 * count)]);
  }
  return chosen;
}

bool has_known_shapes(const scene::Scene& scene) {
  return std::ranges::all_of(scene.probes, has_known_shape);
}

void check_shapes(const scene::Scene& scene) {
  for (std::size_t i = 0; i < scene.probes.size(); ++i) {
    if (has_known_shape(scene.probes[i])) continue;
    throw InputError(
        fmt::format("{}: key 'probes[{}].shape': of a solid the truth is known under spheres and "
                    "capsules only",
                    scene.file.string(), i));
  }
}

ProbePaths::ProbePaths(const scene::Scene& scene, geometry::TriangleSurface skin, double duration)
    : skin_(std::move(skin)) {
  check_shapes(scene);
  std::vector<std::string> warnings;
  for (const auto& probe : scene.probes) {
    forms_.push_back(std::get<geometry::RoundedSegment>(scene::form_of(probe.shape)));
    const auto device = haptics::make_device(probe.device, scene.haptics, warnings);
    auto& poses = poses_.emplace_back();
    for (int k = 0; k <= duration * kRate; ++k) poses.push_back(device->read(k / kRate).pose);
  }
}

geometry::RoundedSegment ProbePaths::probe_at(std::size_t probe, double time) const {
  const auto at =
      std::min(static_cast<std::size_t>(std::lround(time * kRate)), poses_[probe].size() - 1);
  const Pose& pose = poses_[probe][at];
  const auto& form = forms_[probe];
  return {pose.to_world(form.a), pose.to_world(form.b), form.radius};
}

std::vector<double> ProbePaths::touching(std::size_t count) const {
  std::vector<double> times;
  for (std::size_t k = 0; k < poses_.at(0).size(); ++k) {
    const double time = static_cast<double>(k) / kRate;
    bool touches = false;
    for (std::size_t i = 0; i < forms_.size(); ++i) {
      touches = touches ||
                scene::touch_of(skin_, probe_at(i, time)).depth > kLeastDepth * forms_[i].radius;
    }
    if (touches) times.push_back(time);
  }
  return spread(times, count);
}

/// Along the normal where each probe is nearest, until it touches nothing.
truth::Station ProbePaths::freed(const truth::Station& station) const {
  truth::Station free;
  for (const auto& probe : station) {
    const Vec3 outward = scene::touch_of(skin_, probe).outward;
    geometry::RoundedSegment away = probe;
    for (int steps = 1; scene::touch_of(skin_, away).depth > 0; ++steps) {
      if (steps > 40) throw std::runtime_error("a probe finds no straight way out of the organ");
      away = moved(probe, steps * probe.radius / 4 * outward);
    }
    free.push_back(away);
  }
  return free;
}

truth::Question ProbePaths::question_at(double time, std::vector<std::uint32_t>& probes) const {
  truth::Question question;
  truth::Station station;
  probes.clear();
  for (std::uint32_t i = 0; i < forms_.size(); ++i) {
    const auto probe = probe_at(i, time);
    if (scene::touch_of(skin_, probe).depth < (1 - kNear) * probe.radius) continue;
    station.push_back(probe);
    probes.push_back(i);
  }
  question.free = freed(station);
  question.stations.push_back(std::move(station));
  return question;
}

std::vector<scene::Region> ProbePaths::regions() const {
  std::vector<scene::SphereRegion> balls;
  for (std::size_t i = 0; i < forms_.size(); ++i) {
    for (std::size_t k = 0; k < poses_[i].size(); ++k) {
      scene::add_touched(skin_, probe_at(i, static_cast<double>(k) / kRate), balls);
    }
  }
  return {balls.begin(), balls.end()};
}

double ProbePaths::smallest_radius() const {
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto& form : forms_) smallest = std::min(smallest, form.radius);
  return smallest;
}

}  // namespace palpate::plan
