// An organ of quadratic tetrahedra with continuous pressure, nearly or fully incompressible
// neo-Hookean tissue (elements/mixed_solid.h), by backward Euler:
//   M (1 + h·drag)/h² (x⁺ − x̂) = forces(x⁺, p⁺) − Bᵀ (contact forces),
//   x̂ = x + h (v + h·gravity)/(1 + h·drag),   v⁺ = (x⁺ − x)/h
// solved by Newton's method with a direct solver (elements/equilibrium.h), contacts inside
// (quadratic_elements_contact.h). M is consistent with the elements, not the organ's lumped masses:
// those put frequencies 3 to 8 % too low where these err by 0.1 to 0.5 % (docs/elements.md).
//
// The most accurate model there is, and not for real time. The state is positions and velocities
// alone, hence backward Euler: a mode of frequency ω loses by it the part 1 − 1/√(1 + h²ω²) of its
// amplitude per step; at rest it leaves no error. Pressures kept between steps only save
// iterations.
//
// Where Newton fails, the step is divided into 2, 4, 8 parts; where that fails too, the organ
// stays where it is, at rest, and the report says so.
#pragma once

#include <span>
#include <vector>

#include "deformation/contact/quadratic_elements_contact.h"
#include "deformation/steppers/equilibrium.h"
#include "deformation/steppers/organ_dynamics.h"

namespace palpate::deformation {

/// The organ's tetrahedra. Nodes are numbered as in the model.
elements::MixedSolid quadratic_solid(const OrganModel& model);

/// Volume of the tetrahedra around each corner, a quarter of each [m³]  (corner_count)
Eigen::VectorXd corner_volumes(const elements::QuadraticMesh& mesh);

/// Three per node: whether it is fixed.
std::vector<char> held_coordinates(const OrganModel& model);

class QuadraticElements : public OrganDynamics {
 public:
  /// Contacts are taken as flat over a step [s].
  static constexpr double kLargestStep = 0.01;
  static constexpr int kMostParts = 8;
  /// A step that has used up as many factorizations begins no further try: solvable ones need 3 to
  /// 30, and a loop that steps must not wait for what will not converge.
  static constexpr int kMostIterations = 100;

  /// @param model  outlives this, quadratic
  explicit QuadraticElements(const OrganModel& model);

  double largest_step() const override { return kLargestStep; }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override;
  /// With the pressures of the last step if it left this state, else of the shape alone.
  double elastic_energy(const OrganState& state) override;

  int iterations_used() const { return iterations_used_; }  ///< factorizations of the last step

 private:
  bool advance(double h, int parts, std::span<ContactRow> rows, OrganState& state);
  bool solve(const elements::Inertia& inertia, const std::vector<Vec3>& velocities, double h);
  bool gives_up() const { return iterations_used_ >= kMostIterations; }
  double mean_pressure() const;

  const OrganModel& model_;
  elements::MixedSolid solid_;
  QuadraticElementsContact contact_;
  elements::EquilibriumSolver solver_;
  elements::SolidState end_;        ///< of the last step: its pressures are where Newton starts
  Eigen::VectorXd corner_volumes_;  ///< a quarter of each tetrahedron's [m³]  (corner_count)
  OrganState trial_;
  std::vector<Vec3> predicted_;
  int iterations_used_ = 0;
};

}  // namespace palpate::deformation
