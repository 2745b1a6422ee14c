#include "deformation/contact_solve.h"

#include <algorithm>
#include <cmath>

namespace palpate::deformation {
namespace {

/// At least this part of a contact's inverse mass is kept when the volume removes mobility from
/// it: a contact that holds the whole organ could otherwise not be moved at all.
constexpr double kLeastMobility = 1e-3;
constexpr double kVelocityTolerance = 1e-9;  // [m/s]
constexpr int kMaxSweeps = 60;

/// A row with what Gauss–Seidel needs at every visit.
struct PreparedRow {
  double inverse_mass = 0;              ///< Σ b² /m [1/kg]
  double normal_inverse_mass = 0;       ///< the same along n with σ eliminated [1/kg]
  Vec3 volume_coupling = Vec3::Zero();  ///< Σ b g/m [m²/kg]
  double allowed_approach = 0;          ///< gap/h, or minus the separation speed [m/s]
};

class Solver {
 public:
  Solver(const OrganModel& model, const VolumeRow* volume, double h, std::span<ContactRow> rows,
         std::vector<Vec3>& velocities, StartImpulses start)
      : model_(model), volume_(volume), rows_(rows), velocities_(velocities) {
    prepared_.resize(rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) prepare(rows[r], h, prepared_[r]);
    for (std::size_t r = 0; start == StartImpulses::kToApply && r < rows.size(); ++r) {
      // Start values are only a guess, but must lie in the cone of this row.
      rows[r].tangential_impulse -= rows[r].normal * rows[r].normal.dot(rows[r].tangential_impulse);
      clamp_to_cone(rows[r]);
      add_impulse(r, rows[r].tangential_impulse - rows[r].normal_impulse * rows[r].normal);
    }
    if (volume_ != nullptr) {
      // g·w summed here once; afterwards every impulse updates it.
      volume_velocity_ = 0;
      for (std::size_t i = 0; i < volume_->at.gradient.size(); ++i) {
        volume_velocity_ += volume_->at.gradient[i].dot(velocities_[i]);
      }
    }
  }

  /// One visit of every contact; the largest change of a contact velocity [m/s].
  double sweep() {
    double change = 0;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      if (prepared_[r].inverse_mass == 0) continue;
      change = std::max(change, relax_normal(r));
      change = std::max(change, relax_friction(r));
    }
    return change;
  }

  double volume_impulse() const {
    return volume_ == nullptr ? 0 : (volume_->rate + volume_velocity_) / volume_->at.denominator;
  }

  void apply_volume_impulse() {
    if (volume_ == nullptr) return;
    const double sigma = volume_impulse();
    for (std::size_t i = 0; i < volume_->at.gradient.size(); ++i) {
      velocities_[i] -= (model_.inverse_masses[i] * sigma) * volume_->at.gradient[i];
    }
  }

 private:
  void prepare(const ContactRow& row, double h, PreparedRow& prepared) {
    for (int k = 0; k < 3; ++k) {
      const double b_over_m = row.weights[k] * model_.inverse_masses[row.nodes[k]];
      prepared.inverse_mass += row.weights[k] * b_over_m;
      if (volume_ != nullptr)
        prepared.volume_coupling += b_over_m * volume_->at.gradient[row.nodes[k]];
    }
    double reduction = 0;
    if (volume_ != nullptr) {
      const double coupling = row.normal.dot(prepared.volume_coupling);
      reduction = coupling * coupling / volume_->at.denominator;
    }
    prepared.normal_inverse_mass =
        std::max(prepared.inverse_mass - reduction, kLeastMobility * prepared.inverse_mass);
    prepared.allowed_approach = std::max(row.gap / h, -kMaxSeparationSpeed);
  }

  static void clamp_to_cone(ContactRow& row) {
    const double limit = row.friction * row.normal_impulse;
    const double norm = row.tangential_impulse.norm();
    if (norm > limit) row.tangential_impulse *= norm > 0 ? limit / norm : 0;
  }

  /// Velocity of the tissue relative to the probe at a contact, σ included [m/s].
  Vec3 relative_velocity(std::size_t r) const {
    const ContactRow& row = rows_[r];
    Vec3 velocity = -row.probe_velocity;
    for (int k = 0; k < 3; ++k) velocity += row.weights[k] * velocities_[row.nodes[k]];
    return velocity - volume_impulse() * prepared_[r].volume_coupling;
  }

  void add_impulse(std::size_t r, const Vec3& impulse) {
    const ContactRow& row = rows_[r];
    for (int k = 0; k < 3; ++k) {
      velocities_[row.nodes[k]] += (row.weights[k] * model_.inverse_masses[row.nodes[k]]) * impulse;
    }
    volume_velocity_ += prepared_[r].volume_coupling.dot(impulse);
  }

  double relax_normal(std::size_t r) {
    ContactRow& row = rows_[r];
    const double separation = prepared_[r].allowed_approach - row.normal.dot(relative_velocity(r));
    const double wanted = row.normal_impulse - separation / prepared_[r].normal_inverse_mass;
    const double change = std::max(0.0, wanted) - row.normal_impulse;
    row.normal_impulse += change;
    add_impulse(r, -change * row.normal);
    return std::abs(change) * prepared_[r].normal_inverse_mass;
  }

  double relax_friction(std::size_t r) {
    ContactRow& row = rows_[r];
    if (row.friction == 0) return 0;
    const Vec3 velocity = relative_velocity(r);
    const Vec3 sliding = velocity - row.normal * row.normal.dot(velocity);
    const Vec3 before = row.tangential_impulse;
    row.tangential_impulse -= sliding / prepared_[r].inverse_mass;
    clamp_to_cone(row);
    const Vec3 change = row.tangential_impulse - before;
    add_impulse(r, change);
    return change.norm() * prepared_[r].inverse_mass;
  }

  const OrganModel& model_;
  const VolumeRow* volume_;
  std::span<ContactRow> rows_;
  std::vector<Vec3>& velocities_;
  std::vector<PreparedRow> prepared_;
  double volume_velocity_ = 0;  ///< g·w [m³/s]
};

}  // namespace

ContactSolveReport solve_contacts_and_volume(const OrganModel& model, const VolumeRow* volume,
                                             double h, std::span<ContactRow> rows,
                                             std::vector<Vec3>& velocities, StartImpulses start) {
  ContactSolveReport report;
  if (volume != nullptr &&
      !(volume->at.denominator > kVanishedDenominator * model.rest_denominator)) {
    volume = nullptr;
    report.volume_skipped = true;
  }
  Solver solver(model, volume, h, rows, velocities, start);
  if (!rows.empty()) {
    do {
      ++report.sweeps;
    } while (solver.sweep() > kVelocityTolerance && report.sweeps < kMaxSweeps);
  }
  report.volume_impulse = solver.volume_impulse();
  solver.apply_volume_impulse();
  return report;
}

}  // namespace palpate::deformation
