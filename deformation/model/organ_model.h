// One organ: what is constant while it deforms, and its state.
#pragma once

#include <limits>
#include <vector>

#include "deformation/springs/spring_network.h"
#include "modules/geometry/organ_shape.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

/// What fills a solid organ, and its tissue; without tetrahedra the organ is a surface of springs.
struct SolidElements {
  std::vector<geometry::Tetrahedron> tetrahedra;
  std::vector<std::array<std::uint32_t, 6>> edge_nodes;  ///< as in geometry::OrganShape
  double youngs_modulus = 0;                             ///< [Pa]
  double poisson_ratio = 0;
  double density = 0;  ///< [kg/m³]
};

/// Constant after construction.
struct OrganModel {
  SpringNetwork network;  ///< of a solid: no springs, its nodes inside as virtual nodes
  SolidElements solid;
  std::vector<geometry::Triangle> triangles;
  std::vector<double> masses;          ///< [kg]  (node_count)
  std::vector<double> inverse_masses;  ///< [1/kg], 0 for fixed nodes  (node_count)
  std::vector<double> node_stiffness;  ///< Σ_j k_ij of a node's springs [N/m]  (node_count)
  std::vector<double> spring_damping;  ///< axial, per spring [N·s/m]
  std::vector<std::uint32_t> fixed_nodes;
  Vec3 gravity = Vec3::Zero();  ///< [m/s²]
  double drag = 0;              ///< [1/s]
  bool preserve_volume = true;  ///< V and its gradient are wanted at each step's start
  int volume_corrections = 0;   ///< Newton corrections per step
  double rest_volume = 0;       ///< V₀ [m³]
  double rest_denominator = 0;  ///< gᵀM⁻¹g at rest [m⁴/kg]

  std::size_t node_count() const { return masses.size(); }
  std::size_t surface_node_count() const { return network.surface_node_count; }
};

struct OrganState {
  std::vector<Vec3> positions;   ///< surface nodes, then virtual nodes, in W [m]
  std::vector<Vec3> velocities;  ///< [m/s]
  double volume = 0;             ///< of the positions [m³]
  double target_volume = 0;      ///< V* [m³]
  /// A kept volume is let go for a step that would need |p| above this [Pa]: the contents then push
  /// with just so much, and the volume becomes what it becomes. Not below 0.
  double pressure_limit = std::numeric_limits<double>::infinity();
  double pressure = 0;  ///< p = −λ of the last step [Pa]
};

/// The organ's total mass is density × enclosed volume (filled organ), spread over the surface
/// nodes by area. A tenth as much goes to the virtual nodes by their springs' stiffness (contents
/// that move with the axis), and at least so much that none has more stiffness per mass than the
/// mean surface node; the sum is scaled back to the total. So virtual nodes never limit the step.
/// Spring damping is ζ of the spring's own critical damping, c = 2 ζ √(k m_a m_b/(m_a+m_b)); edge
/// and bending springs take the mean surface node for both ends, so that the springs of a family
/// differ in length only (spring_kernel.h).
/// @param rest_shape  closed, oriented outward, in W [m]; a solid one goes to solid_model.h
/// @throws InputError naming the organ if every node is fixed or the volume is not positive
OrganModel build_organ_model(const scene::Organ& organ, const Vec3& gravity,
                             const geometry::OrganShape& rest_shape);

/// Whether a node at this place is held by one of the organ's regions.
bool is_fixed(const scene::Organ& organ, const Vec3& rest_position);

/// Fixes the first `count` nodes where their rest positions lie in the organ's regions.
/// @throws InputError naming the organ if no node of the surface is left free
void fix_nodes(const scene::Organ& organ, std::size_t count, OrganModel& model);

OrganState rest_state(const OrganModel& model);

/// Bound of the highest squared frequency by Gershgorin's circles of M⁻¹K [rad²/s²]:
/// ω² ≤ 2 max_i Σ_j k_ij/m_i.
double highest_squared_frequency_bound(const OrganModel& model);

/// Largest step [s] for which symplectic Euler with damping evaluated at the old velocity is
/// stable. Each mode ẍ + d ẋ + ω² x = 0 needs 4 − 2 h d − h² ω² > 0, that is
/// h < (2/ω)(√(1+ζ²) − ζ) with ζ = d/2ω; ω and d are taken from Gershgorin's bounds.
double stable_step_bound(const OrganModel& model);

}  // namespace palpate::deformation
