// Forces between the nodes and their barycentre.
//
// D. Bourguignon, M.-P. Cani, "Controlling Anisotropy in Mass-Spring Systems", EG Workshop on
// Computer Animation and Simulation 2000: the vertices of a tetrahedron are drawn to or pushed from
// its barycentre x_B so that the sum of their distances to it stays what it was,
//   F_j = −k (Σ_i ‖x_i − x_B‖ − Σ_i ‖x_i − x_B‖₀) r_j,   r_j = (x_j − x_B)/‖x_j − x_B‖
// a cheap stand-in for the element's volume.
//
// Surface analogue. A surface has no elements, so the whole organ is one: its surface nodes, each
// counting by its share a_j of the rest area (a finer patch must not count more), about their
// barycentre. With the mean distance L = Σ a_j ‖x_j − x_B‖, x_B = Σ a_j x_j, and the energy
// ½ k (L − L*)²:
//
//   F_j = −k (L − L*) a_j (r_j − Σ_i a_i r_i)
//
// The last sum is the reaction on the barycentre, shared out so that linear and angular momentum
// are kept. L* = L₀ (V*/V₀)^{1/3}. k = 3 K A/L₀, A the rest area, answers a uniform inflation with
// the pressure of a penalty of modulus K. Damping is that of the springs.
//
// What it keeps is a mean radius, not a volume: the two agree to first order for a ball only.
#pragma once

#include "deformation/model/organ_model.h"
#include "deformation/volume/volume_rule.h"

namespace palpate::deformation {

class BourguignonCani : public VolumeRule {
 public:
  static constexpr double kModulus = 10e3;  ///< K [Pa]

  explicit BourguignonCani(const OrganModel& model);
  double largest_step() const override { return largest_step_; }
  VolumeAction before_contacts(double h, const OrganState& state, FreeStep& step) override;

  double stored_energy(const OrganState& state) const override;  ///< ½ k (L − L*)² [J]
  /// L of these positions [m].
  double mean_distance(const std::vector<Vec3>& positions) const;

 private:
  double target_distance(const OrganState& state) const;  ///< L* [m]
  Vec3 barycentre(const std::vector<Vec3>& positions) const;
  /// u_j = a_j (r_j − Σ a_i r_i) = ∂L/∂x_j, into directions_; returns L [m].
  double evaluate(const std::vector<Vec3>& positions);

  const OrganModel& model_;
  std::vector<double> shares_;  ///< a_j  (surface_node_count)
  double rest_distance_ = 0;    ///< L₀ [m]
  double stiffness_ = 0;        ///< k [N/m]
  double rest_area_ = 0;        ///< A [m²]
  double largest_step_ = 0;
  std::vector<Vec3> directions_;  ///< u_j
};

}  // namespace palpate::deformation
