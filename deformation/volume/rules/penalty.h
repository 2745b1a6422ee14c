// Volume by a penalty: a pressure proportional to the volume lost.
//
//   p = K (V* − V)/V*,   F_i = p g_i,   g = ∂V/∂q
//
// the force of the energy ½ K (V − V*)²/V*; the global form of the volume energies in
// M. Teschner, B. Heidelberger, M. Müller, M. Gross, "A Versatile and Robust Model for
// Geometrically Complex Deformable Solids", CGI 2004. The contents are a gas or a sponge of bulk
// modulus K: at rest under a load of pressure p the volume is wrong by p/K.
//
// It is a stiffness of rank one, K/V* g gᵀ, whose squared frequency K gᵀM⁻¹g/V* shortens the
// largest step once K is large.
#pragma once

#include "deformation/model/organ_model.h"
#include "deformation/volume/volume_rule.h"

namespace palpate::deformation {

/// K of a scene's `model: penalty` [Pa].
inline constexpr double kPenaltyModulus = 10e3;

class Penalty : public VolumeRule {
 public:
  /// @param modulus  K [Pa], > 0
  explicit Penalty(const OrganModel& model, double modulus = kPenaltyModulus);
  double largest_step() const override { return largest_step_; }
  bool reads_gradient() const override { return true; }
  VolumeAction before_contacts(double h, const OrganState& state, FreeStep& step) override;
  double stored_energy(const OrganState& state) const override;  ///< ½ K (V − V*)²/V* [J]

 private:
  const OrganModel& model_;
  double modulus_, largest_step_;
};

}  // namespace palpate::deformation
