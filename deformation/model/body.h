// What every organ is, whatever it is made of: nodes with masses, a closed surface, what holds it.
#pragma once

#include <cstdint>
#include <vector>

#include "modules/core/types.h"
#include "modules/geometry/triangle_surface.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

/// Constant after construction.
struct Body {
  std::vector<Vec3> rest_positions;  ///< surface nodes, then those inside, in W [m]  (node_count)
  std::size_t surface_node_count = 0;
  std::vector<geometry::Triangle> triangles;  ///< closed, oriented outward
  std::vector<double> masses;                 ///< [kg]  (node_count)
  std::vector<double> inverse_masses;         ///< [1/kg], 0 for fixed nodes  (node_count)
  /// Upper bound of what a node resists with all others held [N/m]  (node_count)
  std::vector<double> node_stiffness;
  std::vector<std::uint32_t> fixed_nodes;
  double youngs_modulus = 0;    ///< of what is fixed [Pa]
  Vec3 gravity = Vec3::Zero();  ///< [m/s²]
  double drag = 0;              ///< [1/s]
  double rest_volume = 0;       ///< V₀ [m³]
  double rest_denominator = 0;  ///< gᵀM⁻¹g at rest [m⁴/kg] (volume_gradient.h)

  std::size_t node_count() const { return masses.size(); }
};

/// Whether a node at this place is held by one of the organ's regions.
bool is_fixed(const scene::Organ& organ, const Vec3& rest_position);

/// Stiffness of the tissue in front of a triangle of fixed nodes, E √A [N/m]: no step moves these,
/// so it gives way as a block of it would that is as thick as the triangle is wide.
double fixed_stiffness(const Body& body, std::uint32_t triangle);

/// How far the fixed nodes that carry a place of a triangle, alone or with others, give way to 1 N
/// there [m/N]; 0: none does.
double fixed_yielding(const Body& body, std::uint32_t triangle, const Vec3& barycentric);

/// Fixes the first `count` nodes where their rest positions lie in the organ's regions.
/// @throws InputError naming the organ if no node of the surface is left free
void fix_nodes(const scene::Organ& organ, std::size_t count, Body& body);

/// Bound of the highest squared frequency by Gershgorin's circles of M⁻¹K [rad²/s²]:
/// ω² ≤ 2 max_i Σ_j k_ij/m_i.
double highest_squared_frequency_bound(const Body& body);

}  // namespace palpate::deformation
