#include "visualizer/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "modules/core/units.h"
#include "modules/scene/models.h"
#include "visualizer/color_map.h"

namespace palpate::visualizer {
namespace {

constexpr double kLeastStrainTop = 0.05;
constexpr double kFelt = 1e-3;                   // less is no touch [N]
constexpr double kLeastDisplacementTop = 0.005;  // [m]
constexpr std::size_t kMostNext = 8;             // surfaces that wait for their positions

bool indices_fit(const SurfaceTopology& surface) {
  const std::size_t nodes = surface.rest_positions.size() / 3;
  if (surface.rest_positions.size() % 3 != 0 || surface.surface_node_count > nodes) return false;
  for (const auto& triangle : surface.triangles) {
    for (const std::uint32_t i : triangle) {
      if (i >= surface.surface_node_count) return false;
    }
  }
  return std::all_of(surface.springs.begin(), surface.springs.end(), [&](const auto& spring) {
    return spring.node_a < nodes && spring.node_b < nodes && spring.family <= SpringFamily::kInner;
  });
}

Vec3 rest_node(const SurfaceTopology& surface, std::uint32_t i) {
  const float* p = surface.rest_positions.data() + 3 * std::size_t{i};
  return {p[0], p[1], p[2]};
}

void sort_springs_by_family(OrganView& organ) {
  for (auto& family : organ.springs) family.clear();
  for (const auto& spring : organ.surface.springs) {
    organ.springs[static_cast<std::size_t>(spring.family)].push_back(
        {spring.node_a, spring.node_b});
  }
}

/// Value that 99.5 % of the values do not exceed; 0 if there are none.
double nearly_largest(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(0.995 * (values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

void follow(double& top, double needed, double least) {
  const double rounded = round_up(std::max(needed, least));
  if (rounded > top || rounded <= 0.25 * top) top = rounded;
}

}  // namespace

Vec3 OrganView::node(std::uint32_t i) const {
  const float* p = newest.positions.data() + 3 * std::size_t{i};
  return {p[0], p[1], p[2]};
}

SceneView::SceneView(const scene::Scene& scene)
    : scene_(scene), organs_(scene.organs.size()), refreshed_(scene.organs.size(), 0) {
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    organs_[i].name = scene.organs[i].name;
    organs_[i].solid = scene::is_solid(scene.organs[i].model);
  }
  for (const scene::Probe& probe : scene.probes) {
    probes_.emplace_back();
    probes_.back().description = probe;
  }
}

void SceneView::note_time(std::int64_t sim_time_ns) { seconds_ = seconds_from_ns(sim_time_ns); }

bool SceneView::receive(SurfaceTopology surface) {
  if (surface.organ >= organs_.size() || !indices_fit(surface)) return false;
  OrganView& organ = organs_[surface.organ];
  if (organ.known) {
    if (organ.next.size() == kMostNext) organ.next.erase(organ.next.begin());
    organ.next.push_back(std::move(surface));
    return true;
  }
  show(std::move(surface));
  return true;
}

/// Puts an organ at rest.
void SceneView::show(SurfaceTopology surface) {
  OrganView& organ = organs_[surface.organ];
  organ.known = true;
  organ.newest = NodePositions{};
  organ.newest.organ = surface.organ;
  organ.newest.generation = surface.generation;
  organ.newest.positions = surface.rest_positions;
  organ.surface = std::move(surface);
  organ.received_ns = 0;
  ++organ.shape_version;
  ++organ.positions_version;
  sort_springs_by_family(organ);
  find_extent();
}

bool SceneView::receive(NodePositions positions, std::int64_t now_ns) {
  if (positions.organ >= organs_.size()) return false;
  OrganView& organ = organs_[positions.organ];
  const auto next =
      std::ranges::find(organ.next, positions.generation, &SurfaceTopology::generation);
  if (next != organ.next.end()) {
    SurfaceTopology surface = std::move(*next);
    organ.next.erase(organ.next.begin(), next + 1);
    show(std::move(surface));
  }
  if (!organ.known || positions.generation != organ.surface.generation ||
      positions.positions.size() != organ.surface.rest_positions.size()) {
    return false;
  }
  organ.newest = std::move(positions);
  organ.received_ns = now_ns;
  ++organ.positions_version;
  note_time(organ.newest.header.sim_time_ns);
  const double time = seconds_from_ns(organ.newest.header.sim_time_ns);
  if (organ.newest.target_volume > 0) {
    organ.volume_error.push(time, organ.newest.volume / organ.newest.target_volume - 1);
  }
  organ.pressure.push(time, organ.newest.pressure);
  return true;
}

bool SceneView::receive(const ProbeState& probe) {
  if (probe.probe >= probes_.size()) return false;
  probes_[probe.probe].seen = true;
  probes_[probe.probe].pose = probe.pose;
  const bool organ_tells_time = std::any_of(organs_.begin(), organs_.end(),
                                            [](const OrganView& o) { return o.received_ns != 0; });
  if (!organ_tells_time) note_time(probe.header.sim_time_ns);
  return true;
}

bool SceneView::receive(Contacts contacts) {
  if (contacts.probe >= probes_.size()) return false;
  probes_[contacts.probe].contacts = std::move(contacts);
  return true;
}

bool SceneView::receive(const ContactModel& law) {
  if (law.probe >= probes_.size()) return false;
  ProbeView& probe = probes_[law.probe];
  if (law.process != probe.error_of_process && law.force_error <= probe.force_error) return true;
  probe.force_error = law.force_error;
  probe.error_of_process = law.process;
  return true;
}

bool SceneView::receive(const HapticForce& force) {
  if (force.probe >= probes_.size()) return false;
  ProbeView& probe = probes_[force.probe];
  const double time = seconds_from_ns(force.header.sim_time_ns), newton = force.force.norm();
  const double since = time - seconds_from_ns(probe.force.header.sim_time_ns);
  if (since < 0) probe.greatest_force = probe.greatest_at = probe.touched_for = 0;  // a reset
  if (probe.has_force && newton > kFelt && since > 0) probe.touched_for += since;
  if (newton > probe.greatest_force) {
    probe.greatest_force = newton;
    probe.greatest_at = time;
  }
  probe.has_force = true;
  probe.force = force;
  probe.force_magnitude.push(time, newton);
  return true;
}

void SceneView::receive(ModuleStatus status, std::int64_t now_ns) {
  ModuleView& view = modules_[status.module];
  view.status = std::move(status);
  view.received_ns = now_ns;
}

void SceneView::receive(const SessionControl& control) { session_ = control; }

void SceneView::refresh() {
  double strain = 0, displacement = 0;
  bool moved = false;
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    OrganView& organ = organs_[i];
    if (refreshed_[i] != organ.positions_version) {
      moved = true;
      refreshed_[i] = organ.positions_version;
      const auto& rest = organ.surface.rest_positions;
      const auto& now = organ.newest.positions;
      node_normals(now, organ.surface.triangles, organ.normals);
      node_displacements(rest, now, organ.displacement);
      triangle_strains(rest, now, organ.surface.triangles, organ.triangle_strain);
      average_to_nodes(rest, organ.surface.triangles, organ.triangle_strain, organ.node_strain);
    }
    strain = std::max(strain, nearly_largest(organ.node_strain));
    displacement = std::max(displacement, nearly_largest(organ.displacement));
  }
  if (!moved) return;
  follow(strain_top_, strain, kLeastStrainTop);
  follow(displacement_top_, displacement, kLeastDisplacementTop);
}

bool SceneView::ended() const {
  const auto deformation = modules_.find("deformation");
  if (ended_) return true;
  return session_.command == SessionCommand::kPause && deformation != modules_.end() &&
         deformation->second.status.state == ModuleState::kStopped;
}

double SceneView::real_time_factor() const {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [name, module] : modules_) {
    if (name.starts_with("deformation")) least = std::min(least, module.status.real_time_factor);
  }
  return std::isfinite(least) ? least : 0;
}

double SceneView::positions_age(std::int64_t now_ns) const {
  double age = 0;
  for (const OrganView& organ : organs_) {
    age = std::max(age, organ.received_ns == 0 ? std::numeric_limits<double>::infinity()
                                               : seconds_from_ns(now_ns - organ.received_ns));
  }
  return age;
}

void SceneView::find_extent() {
  Eigen::AlignedBox3d box;
  for (const OrganView& organ : organs_) {
    for (std::uint32_t i = 0; i < organ.surface.surface_node_count; ++i) {
      box.extend(rest_node(organ.surface, i));
    }
  }
  if (box.isEmpty()) return;
  center_ = box.center();
  radius_ = 1e-3;
  for (const OrganView& organ : organs_) {
    for (std::uint32_t i = 0; i < organ.surface.surface_node_count; ++i) {
      radius_ = std::max(radius_, (rest_node(organ.surface, i) - center_).norm());
    }
  }
}

}  // namespace palpate::visualizer
