// An organ as a sum of its lowest vibrations, for small deformation.
//   A. Pentland, J. Williams, "Good vibrations: modal dynamics for graphics and animation",
//   SIGGRAPH 1989;  D. James, D. Pai, "DyRT", ACM Trans. Graph. 21, 2002.
//
// Displacements from rest are u = U a with modes U, UᵀMU = 1, of the quadratic elements
// (modal_analysis.h). A body that nothing holds has its six rigid motions among them, rotation
// linearised: it swells as it turns, by 1.5 % at 10°. Each mode is an oscillator
//   ä + (2ζω + drag) ȧ + ω² a = Uᵀ (M gravity + contact forces)
// with ζ the tissue's damping ratio. The amplitudes are state.internal's; of an organ put elsewhere
// from outside they are a = UᵀM (x − X), and what the modes cannot show is dropped.
//
// While no contact would be penetrated, motion is exact for any step. Else the step is backward
// Euler, whose damping keeps contacts from ringing, with W = U (1 + h(2ζω + drag) + h²ω²)⁻¹ Uᵀ as
// what velocities answer impulses by, and projected Gauss–Seidel on the rows.
//
// Linear: forces grow with the indentation, not faster, shape keeps volume to first order only, and
// what the modes left out would give under a small probe is missing: it feels too hard.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "deformation/model/organ_model.h"
#include "deformation/steppers/organ_dynamics.h"

namespace palpate::deformation {

class Modal : public OrganDynamics {
 public:
  /// Contacts are taken as flat over a step [s].
  static constexpr double kLargestStep = 0.01;

  /// @param model          quadratic, outlives this
  /// @param count          of vibrations, beside rigid motion; as many as the mesh has, at most
  /// @param damping_ratio  ζ ≥ 0
  Modal(const OrganModel& model, std::size_t count, double damping_ratio);

  double largest_step() const override { return kLargestStep; }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override;
  Eigen::MatrixXd compliance(std::span<const ComplianceRow> rows,
                             const PeriodSteps& steps) const override;
  double elastic_energy(const OrganState& state) override;

  const Eigen::VectorXd& angular_frequencies() const { return frequencies_; }  ///< rising [rad/s]

 private:
  /// A contact row in amplitudes.
  struct Row {
    Eigen::Matrix3Xd motion;  ///< of its tissue point by the amplitudes  (3 × modes)
    double allowed = 0;       ///< gap/h [m/s]
    double along = 0;         ///< inverse effective mass along n [1/kg]
    double across = 0;        ///< at least the most across n [1/kg]
    Yielding yielding;
  };

  void find_modes(std::size_t count);
  Eigen::VectorXd amplitudes(const OrganState& state) const;
  void write(OrganState& state) const;
  bool move_freely(double h, std::span<ContactRow> contacts, InternalState& state) const;
  void move_in_touch(double h, std::span<ContactRow> contacts, InternalState& state) const;
  void prepare(double h, std::span<const ContactRow> contacts);
  /// Separation speed beyond what is allowed along n, < 0: penetrates [m/s]
  double separation(std::size_t row, const ContactRow& contact, const Eigen::VectorXd& rates) const;
  void add_impulse(const Row& row, const Vec3& impulse, Eigen::VectorXd& rates) const;
  double relax(std::size_t row, ContactRow& contact, Eigen::VectorXd& rates) const;

  const OrganModel& model_;
  Eigen::MatrixXd modes_;         ///< U [kg^−½]  (3 node_count × modes)
  Eigen::MatrixXd momenta_;       ///< M U [kg^½]  (3 node_count × modes)
  Eigen::VectorXd frequencies_;   ///< ω  (modes)
  Eigen::VectorXd pressures_;     ///< mean pressure per amplitude  (modes)
  Eigen::VectorXd damping_;       ///< 2ζω + drag [1/s]  (modes)
  Eigen::VectorXd load_;          ///< UᵀM gravity  (modes)
  Eigen::VectorXd inverse_mass_;  ///< (1 + h(2ζω + drag) + h²ω²)⁻¹  (modes)
  std::vector<Row> rows_;
};

}  // namespace palpate::deformation
