// One volume constraint per element.
//
// M. Müller, B. Heidelberger, M. Hennix, J. Ratcliff, "Position Based Dynamics", JVCIR 18, 2007
// (projection of one constraint after the other); G. Irving, C. Schroeder, R. Fedkiw, "Volume
// conserving finite element simulations of deformable models", ACM TOG 26(3), 2007 (tissue keeps
// its volume locally, not only as a whole).
//
// Elements are the pyramids over the surface's triangles (pyramids.h). Each has the implicit
// constraint of its own, Φ_t + h g_t·v⁺ = 0, visited one after the other (Gauss–Seidel), forwards
// and then backwards so that the order has no side:
//
//   σ_t = (Φ_t/h + g_t·v)/(g_tᵀM⁻¹g_t),   v ← v − M⁻¹g_t σ_t
//
// for kSweeps sweeps, from zero in every step; then contacts, then positions. What the sweeps have
// not solved remains: like all position-based methods it is softer with fewer sweeps and longer
// steps. Twice as many constraints as surface nodes leave a third of the freedom: the organ locks,
// and answers a squeeze several times stiffer than a shell filled with fluid.
#pragma once

#include "deformation/model/organ_model.h"
#include "deformation/volume/rules/pyramids.h"
#include "deformation/volume/volume_rule.h"

namespace palpate::deformation {

class ElementVolume : public VolumeRule {
 public:
  static constexpr int kSweeps = 4;

  /// @param model  has virtual nodes
  explicit ElementVolume(const OrganModel& model);
  double largest_step() const override { return largest_step_; }
  VolumeAction before_contacts(double h, const OrganState& state, FreeStep& step) override;

 private:
  struct Constraint {
    PyramidVolume at;
    double rate = 0;         ///< Φ_t/h [m³/s]
    double denominator = 0;  ///< g_tᵀM⁻¹g_t [m⁴/kg]
    double impulse = 0;      ///< Σ of σ_t over the sweeps [Pa·s]
  };

  double inverse_mass_along(const Pyramid& pyramid, const PyramidVolume& at) const;
  bool prepare(double h, const OrganState& state);  ///< false if some pyramid has collapsed
  void relax(std::size_t t, std::vector<Vec3>& velocities);

  const OrganModel& model_;
  std::vector<Pyramid> pyramids_;
  double mean_denominator_ = 0;  ///< of g_tᵀM⁻¹g_t at rest [m⁴/kg]
  double largest_step_;
  std::vector<Constraint> constraints_;
};

}  // namespace palpate::deformation
