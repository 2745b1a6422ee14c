// What touches a solid, as Newton's method sees it: forces on the nodes of single elements.
#pragma once

#include "deformation/elements/taylor_hood.h"

namespace palpate::deformation {

class ElementContact {
 public:
  virtual ~ElementContact() = default;

  /// Adds what touches this element.
  /// @param positive  the tangent is to be positive semidefinite or nearly so, for a way downhill;
  ///                  else the forces' derivative, without which Newton creeps towards its end
  virtual void add_residual(std::size_t element, const SolidState& state,
                            ElementVector& residual) const = 0;
  virtual void add_tangent(std::size_t element, const SolidState& state, ElementMatrix& tangent,
                           bool positive) const = 0;

  virtual double deepest(const SolidState& state) const = 0;  ///< penetration, ≥ 0 [m]
  /// Whether forces agree with what they were bounded by; if not, they are augmented.
  virtual bool is_settled(const SolidState& /*state*/) const { return true; }
  /// Takes the forces there are as multipliers, so that the next equilibrium penetrates less.
  virtual void augment(const SolidState& state) = 0;
};

}  // namespace palpate::deformation
