// Friction inside the solve of an implicit step.
//
// Gauss–Seidel judges a row's friction by its nodes' own inverse mass, a hundredth of what a fine
// wall gives way by: nearly all rows seem to slide, and with that friction as a given force an
// implicit solve turns them about, so that it drives what it should hold. So there friction is
// linear in the sliding velocity v,
//     t = κ (t⁰/c − v),   κ = min(c, μ j/|v' − t⁰/c|)
// with v' what is known of v, t⁰ the friction of the step before and c the row's own mass across n:
// one Picard iteration of Coulomb's law. Where it sticks, t = t⁰ − c v: it moves only while its
// friction changes (P. Alart, A. Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991); where it
// slides, t is of size μ j against v (lagged: M. Li et al., "Incremental Potential Contact",
// SIGGRAPH 2020). It takes energy whatever v comes out, but for what t⁰ has stored.
#pragma once

#include <span>
#include <vector>

#include "deformation/contact/contact_solve.h"
#include "deformation/springs/spring_hessian_product.h"

namespace palpate::deformation {

class LaggedFriction {
 public:
  /// Keeps t⁰, the friction that the rows bring.
  void begin(std::span<const ContactRow> rows);

  /// Finds κ of the rows that press, with v' at these velocities, and gives the rows their t there.
  /// @param inverse_mass_blocks  W, zero for fixed nodes [1/kg]  (node_count)
  /// @param velocities  of the nodes [m/s]  (node_count)
  void linearise(std::span<const Mat3> inverse_mass_blocks, const std::vector<Vec3>& velocities,
                 std::span<ContactRow> rows);
  /// −∂t/∂v
  void append_couplings(std::span<const ContactRow> rows,
                        std::vector<ContactCoupling>& couplings) const;
  /// Gives the rows their t at these velocities: μ j to those that slide, no more to the others;
  /// and gives the nodes the difference from the linear law, which the velocities come from.
  void apply(std::span<const Mat3> inverse_mass_blocks, std::vector<Vec3>& velocities,
             std::span<ContactRow> rows) const;

 private:
  struct Law {
    double coefficient = 0;      ///< κ [kg]; 0: no friction
    bool slides = false;         ///< v' is beyond what c can hold
    Vec3 offset = Vec3::Zero();  ///< t⁰/c [m/s]
    Vec3 at(const Vec3& sliding) const { return coefficient * (offset - sliding); }
  };
  std::vector<Vec3> anchors_;  ///< t⁰ [N·s]
  std::vector<Law> laws_;      ///< by row
};

}  // namespace palpate::deformation
