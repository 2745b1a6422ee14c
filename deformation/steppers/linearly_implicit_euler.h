// Linearly implicit Euler: of backward Euler, one Newton iteration from the inertial prediction
// x̃ = x + h v,
//   A Δv = h f(x̃) + h M (gravity − drag v) − Bᵀ (impulses),   A = (1 + h·drag) M + h² K(x̃)
// by preconditioned conjugate gradients, the contacts inside (augmented_contacts.h): as a convex
// energy that is quadratic in pieces, with as long a step each time as it falls. So no contact is
// overshot, and the impulses are those of the velocities found, however few iterations are made.
// And again where tissue would end deeper in a probe than it may by kUnsolvedDepth. What the
// iterations leave of the residual acts on in the next step: equilibria are those of f.
//   E. Polak, G. Ribière, Rev. Fr. Inform. Rech. Opér. 3 (16), 1969.
//   D. Baraff, A. Witkin, "Large steps in cloth simulation", SIGGRAPH 1998.
//
// Elements that keep their volume by pressures remember these (augmented_pressures.h), in
// state.internal.
//
// There is no global volume constraint: tissue keeps its volume by what it is made of, and
// state.target_volume is not looked at.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "deformation/contact/augmented_contacts.h"
#include "deformation/elements/elastic_force_elements.h"
#include "deformation/steppers/augmented_pressures.h"
#include "deformation/steppers/organ_dynamics.h"

namespace palpate::deformation {

class LinearlyImplicitEuler : public OrganDynamics {
 public:
  /// Not for stability: contacts are taken as flat over a step [s].
  static constexpr double kLargestStep = 0.01;

  /// @param body       outlives this
  /// @param iterations  of conjugate gradients per step, at most; up to three times as many while
  ///                    what contacts press with has not settled
  LinearlyImplicitEuler(const Body& body, std::unique_ptr<ElasticForceElements> elements,
                        int iterations);

  double largest_step() const override { return kLargestStep; }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override;
  void add_stiffness(const Patch& patch, Eigen::MatrixXf& sum) const override;
  StepMatrix step_matrix() const override {
    if (!(step_ > 0)) return {};
    return {.elements = elements_.get(), .shift = shift_, .positions = predicted_, .step = step_};
  }
  void foresee(const OrganState& state) override;
  double elastic_energy(const OrganState& state) override {
    return elements_->energy(state.positions);
  }

  int iterations_used() const { return iterations_used_; }  ///< of the last step

 private:
  void linearise(double h, const OrganState& state);
  void begin_with_free_motion();
  /// Δv and the contacts' impulses together.
  void solve(double h, std::span<ContactRow> rows, const OrganState& state);
  /// @param spare  iterations that may be made beside the usual; gets what is left
  void descend(int& spare, std::span<ContactRow> rows, const OrganState& state);
  /// Δv += length p, r −= length · product, z = P r.
  Gone go(double length);
  /// p = z + kept p, or z where that leads up. @returns r·p
  double turn(double kept);
  void take_preconditioner(std::span<const ContactRow> rows);
  void take_residual(std::span<const ContactRow> rows);
  void set_preconditioner(std::size_t node, const Mat3& inverse);
  void keep_momentum(double h, std::span<const ContactRow> rows, const OrganState& state);
  double mean_pressure() const;

  const Body& body_;
  std::unique_ptr<ElasticForceElements> elements_;
  int max_iterations_, iterations_used_ = 0;
  double total_mass_ = 0, step_ = 0;  ///< [kg]; h of the last step [s]
  AugmentedContacts contacts_;
  AugmentedPressures pressures_;
  std::vector<double> shift_;                         ///< (1 + h·drag) m [kg]
  std::vector<Vec3> predicted_;                       ///< x̃ [m]
  std::vector<Vec3> velocities_;                      ///< v + Δv [m/s]
  std::vector<Mat3> inverse_diagonal_;                ///< of A without contacts [1/kg]
  std::vector<Mat3> diagonal_;                        ///< with contacts, of their nodes [kg]
  std::vector<std::array<Vec4f, 3>> preconditioner_;  ///< its inverse blocks, by columns
  std::vector<Vec4f> change_;                         ///< Δv [m/s]
  std::vector<Vec4f> load_;                           ///< right-hand side without contacts [N·s]
  std::vector<Vec4f> residual_;                       ///< r [N·s]
  std::vector<Vec4f> preconditioned_, direction_, product_;
};

}  // namespace palpate::deformation
