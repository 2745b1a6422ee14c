// How the volume acts on a step of symplectic Euler: what one method differs from another in. The
// rule knows no springs' kernel, no contacts and no stepper.
#pragma once

#include <limits>
#include <optional>

#include "deformation/model/free_step.h"
#include "deformation/model/organ_state.h"

namespace palpate::deformation {

/// What a rule asks of the step, before contacts are solved.
struct VolumeAction {
  /// A multiplier σ along g, solved with the contacts: (gᵀM⁻¹g) σ = rate + g·v̂ [m³/s]. None: the
  /// rule has added its own impulses to v̂.
  std::optional<double> rate = std::nullopt;
  std::optional<double> pressure = std::nullopt;  ///< p of the rule's own impulses [Pa]; none: −σ/h
  bool skipped = false;  ///< some volume could not be corrected: its gradient vanished
};

class VolumeRule {
 public:
  virtual ~VolumeRule() = default;

  /// The largest step of springs and rule together, a safety factor included [s].
  virtual double largest_step() const = 0;
  /// Whether before_contacts() is to find V, g and gᵀM⁻¹g in the free step.
  virtual bool reads_gradient() const { return false; }
  /// Newton corrections of the constraint at the step's end.
  virtual int corrections() const { return 0; }

  /// @param state  at the step's start
  /// @param step   its velocities v̂ may be changed
  virtual VolumeAction before_contacts(double h, const OrganState& state, FreeStep& step) = 0;

  /// Whether after_step() is given V, g and gᵀM⁻¹g at the step's end.
  virtual bool reads_end_gradient() const { return false; }
  /// Corrects what is wrong at the step's end. May set the pressure.
  /// @returns false if it could not, for the volume's gradient vanished
  virtual bool after_step(double /*h*/, const VolumeGradient& /*end*/, OrganState& /*state*/) {
    return true;
  }

  /// In the contents, of the rule's own forces [J].
  virtual double stored_energy(const OrganState& /*state*/) const { return 0; }
};

}  // namespace palpate::deformation
