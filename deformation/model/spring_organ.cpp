#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "deformation/model/organ_model.h"
#include "deformation/model/volume_gradient.h"
#include "modules/core/error.h"
#include "modules/scene/models.h"

namespace palpate::deformation {
namespace {

SpringNetwork springs_of(const scene::Organ& organ, const geometry::TriangleSurface& rest_surface) {
  try {
    return build_spring_network(rest_surface, organ.tissue, organ.springs);
  } catch (const InputError& error) {
    throw InputError("organ '" + organ.name + "': " + organ.mesh.file.string() + ": " +
                     error.what());
  }
}

/// Σ_j k_ij of each node [N/m].
std::vector<double> stiffness_sums(const SpringNetwork& network, std::size_t node_count) {
  std::vector<double> sums(node_count, 0);
  for (const Spring& spring : network.springs) {
    sums[spring.node_a] += spring.stiffness;
    sums[spring.node_b] += spring.stiffness;
  }
  return sums;
}

/// Part of the mass that moves with the axis: the contents around it.
constexpr double kAxialShare = 0.1;

std::vector<double> node_masses(const SpringNetwork& network, const std::vector<double>& stiffness,
                                double total_mass) {
  const std::size_t surface_count = network.node_areas.size();
  const auto first_virtual = stiffness.begin() + static_cast<long>(surface_count);
  const double area = std::accumulate(network.node_areas.begin(), network.node_areas.end(), 0.0);
  const double surface_stiffness = std::accumulate(stiffness.begin(), first_virtual, 0.0);
  const double axial_stiffness = std::accumulate(first_virtual, stiffness.end(), 0.0);

  std::vector<double> masses(stiffness.size());
  for (std::size_t i = 0; i < masses.size(); ++i) {
    masses[i] = i < surface_count
                    ? total_mass * network.node_areas[i] / area
                    : total_mass * stiffness[i] *
                          std::max(kAxialShare / axial_stiffness, 1 / surface_stiffness);
  }
  const double scale = total_mass / std::accumulate(masses.begin(), masses.end(), 0.0);
  for (double& mass : masses) mass *= scale;
  return masses;
}

/// Axial damping coefficients c of all springs [N·s/m].
std::vector<double> axial_damping(const SpringNetwork& network, const std::vector<double>& masses,
                                  double damping_ratio) {
  const auto first_virtual = masses.begin() + static_cast<long>(network.node_areas.size());
  const double mean_mass = std::accumulate(masses.begin(), first_virtual, 0.0) /
                           static_cast<double>(network.node_areas.size());
  std::vector<double> damping(network.springs.size());
  for (std::size_t s = 0; s < damping.size(); ++s) {
    const Spring& spring = network.springs[s];
    const double m_a = masses[spring.node_a], m_b = masses[spring.node_b];
    const double reduced_mass =
        network.family(s) == SpringFamily::kInner ? m_a * m_b / (m_a + m_b) : mean_mass / 2;
    damping[s] = 2 * damping_ratio * std::sqrt(spring.stiffness * reduced_mass);
  }
  return damping;
}

}  // namespace

OrganModel build_organ_model(const scene::Organ& organ, const Vec3& gravity,
                             const geometry::OrganShape& rest_shape) {
  if (const auto misfit = scene::impossible_for_model(organ); !misfit.none()) {
    throw InputError("organ '" + organ.name + "': key '" + misfit.key + "': " + misfit.why);
  }
  return rest_shape.is_solid() ? build_solid(organ, gravity, rest_shape)
                               : build_spring_organ(organ, gravity, rest_shape.surface);
}

OrganModel build_spring_organ(const scene::Organ& organ, const Vec3& gravity,
                              const geometry::TriangleSurface& rest_surface) {
  OrganModel model;
  model.rest_volume = geometry::enclosed_volume(rest_surface.nodes, rest_surface.triangles);
  if (!(model.rest_volume > 0)) {
    throw InputError("organ '" + organ.name + "': its surface encloses no positive volume");
  }
  SpringNetwork network = springs_of(organ, rest_surface);
  model.surface_node_count = rest_surface.nodes.size();
  model.rest_positions = rest_surface.nodes;
  model.rest_positions.insert(model.rest_positions.end(), network.virtual_nodes.begin(),
                              network.virtual_nodes.end());
  model.triangles = rest_surface.triangles;
  model.node_stiffness = stiffness_sums(network, model.rest_positions.size());
  model.masses =
      node_masses(network, model.node_stiffness, organ.tissue.density * model.rest_volume);
  for (const double mass : model.masses) model.inverse_masses.push_back(1 / mass);
  fix_nodes(organ, model.surface_node_count, model);
  network.damping = axial_damping(network, model.masses, organ.tissue.damping_ratio);
  model.material = std::move(network);
  model.gravity = gravity;
  model.drag = organ.tissue.drag;

  VolumeGradient at_rest;
  evaluate_volume(model, model.rest_positions, at_rest);
  model.rest_denominator = at_rest.denominator;
  return model;
}

double stable_step_bound(const OrganModel& model) {
  std::vector<double> damping_sums(model.node_count(), 0);
  for (std::size_t s = 0; s < model.network().springs.size(); ++s) {
    damping_sums[model.network().springs[s].node_a] += model.network().damping[s];
    damping_sums[model.network().springs[s].node_b] += model.network().damping[s];
  }
  double d = 0;
  for (std::size_t i = 0; i < damping_sums.size(); ++i) {
    d = std::max(d, 2 * damping_sums[i] * model.inverse_masses[i]);
  }
  d += model.drag;
  const double omega_squared = highest_squared_frequency_bound(model);
  return (std::sqrt(d * d + 4 * omega_squared) - d) / omega_squared;
}

}  // namespace palpate::deformation
