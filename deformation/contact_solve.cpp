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

/// Nodes answer impulses by their mass.
class MassMobility {
 public:
  explicit MassMobility(const OrganModel& model) : inverse_masses_(model.inverse_masses) {}

  /// Velocity that node takes from scale · impulse.
  Vec3 answer(std::size_t node, double scale, const Vec3& impulse) const {
    return (scale * inverse_masses_[node]) * impulse;
  }
  /// Σ b² W along n, and the most it is across n [1/kg]
  std::array<double, 2> along_and_across(const ContactRow& row) const {
    double inverse_mass = 0;
    for (int k = 0; k < 3; ++k) {
      inverse_mass += row.weights[k] * (row.weights[k] * inverse_masses_[row.nodes[k]]);
    }
    return {inverse_mass, inverse_mass};
  }

 private:
  const std::vector<double>& inverse_masses_;
};

/// Nodes answer impulses by a symmetric matrix W each.
class BlockMobility {
 public:
  explicit BlockMobility(std::span<const Mat3> mobilities) : mobilities_(mobilities) {}

  Vec3 answer(std::size_t node, double scale, const Vec3& impulse) const {
    return scale * (mobilities_[node] * impulse);
  }
  std::array<double, 2> along_and_across(const ContactRow& row) const {
    Mat3 sum = Mat3::Zero();
    for (int k = 0; k < 3; ++k) {
      sum += (row.weights[k] * row.weights[k]) * mobilities_[row.nodes[k]];
    }
    const Vec3 t = row.normal.unitOrthogonal(), s = row.normal.cross(t);
    const double tt = t.dot(sum * t), ss = s.dot(sum * s), ts = t.dot(sum * s);
    return {row.normal.dot(sum * row.normal), (tt + ss + std::hypot(tt - ss, 2 * ts)) / 2};
  }

 private:
  std::span<const Mat3> mobilities_;
};

/// A row with what Gauss–Seidel needs at every visit.
struct PreparedRow {
  double normal_mobility = 0;           ///< Σ b² W along n with σ eliminated [1/kg]
  double tangential_mobility = 0;       ///< Σ b² W across n, the most of it [1/kg]
  Vec3 volume_coupling = Vec3::Zero();  ///< Σ b W g [m²/kg]
  double allowed_approach = 0;          ///< gap/h, or minus the separation speed [m/s]
};

template <class Mobility>
class Solver {
 public:
  Solver(const Mobility& mobility, const VolumeRow* volume, double volume_velocity, double h,
         std::span<ContactRow> rows, std::vector<Vec3>& velocities, StartImpulses start)
      : mobility_(mobility),
        volume_(volume),
        rows_(rows),
        velocities_(velocities),
        volume_velocity_(volume_velocity) {
    prepared_.resize(rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) prepare(rows[r], h, prepared_[r]);
    for (std::size_t r = 0; start == StartImpulses::kToApply && r < rows.size(); ++r) {
      // Start values are only a guess, but must lie in the cone of this row.
      rows[r].tangential_impulse -= rows[r].normal * rows[r].normal.dot(rows[r].tangential_impulse);
      clamp_to_cone(rows[r]);
      add_impulse(r, rows[r].tangential_impulse - rows[r].normal_impulse * rows[r].normal);
    }
  }

  /// One visit of every contact; the largest change of a contact velocity [m/s].
  double sweep() {
    double change = 0;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      if (prepared_[r].tangential_mobility == 0) continue;  // all nodes fixed
      change = std::max(change, relax_normal(r));
      change = std::max(change, relax_friction(r));
    }
    return change;
  }

  double volume_impulse() const {
    return volume_ == nullptr ? 0 : (volume_->rate + volume_velocity_) / volume_->at.denominator;
  }

 private:
  void prepare(const ContactRow& row, double h, PreparedRow& prepared) {
    const auto [along, across] = mobility_.along_and_across(row);
    double reduction = 0;
    if (volume_ != nullptr) {
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t node = row.nodes[k];
        prepared.volume_coupling +=
            mobility_.answer(node, row.weights[k], volume_->at.gradient[node]);
      }
      const double coupling = row.normal.dot(prepared.volume_coupling);
      reduction = coupling * coupling / volume_->at.denominator;
    }
    prepared.normal_mobility = std::max(along - reduction, kLeastMobility * along);
    prepared.tangential_mobility = across;
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
      velocities_[row.nodes[k]] += mobility_.answer(row.nodes[k], row.weights[k], impulse);
    }
    volume_velocity_ += prepared_[r].volume_coupling.dot(impulse);
  }

  double relax_normal(std::size_t r) {
    ContactRow& row = rows_[r];
    const double separation = prepared_[r].allowed_approach - row.normal.dot(relative_velocity(r));
    const double wanted = row.normal_impulse - separation / prepared_[r].normal_mobility;
    const double change = std::max(0.0, wanted) - row.normal_impulse;
    row.normal_impulse += change;
    add_impulse(r, -change * row.normal);
    return std::abs(change) * prepared_[r].normal_mobility;
  }

  double relax_friction(std::size_t r) {
    ContactRow& row = rows_[r];
    if (row.friction == 0) return 0;
    const Vec3 velocity = relative_velocity(r);
    const Vec3 sliding = velocity - row.normal * row.normal.dot(velocity);
    const Vec3 before = row.tangential_impulse;
    row.tangential_impulse -= sliding / prepared_[r].tangential_mobility;
    clamp_to_cone(row);
    const Vec3 change = row.tangential_impulse - before;
    add_impulse(r, change);
    return change.norm() * prepared_[r].tangential_mobility;
  }

  const Mobility& mobility_;
  const VolumeRow* volume_;
  std::span<ContactRow> rows_;
  std::vector<Vec3>& velocities_;
  std::vector<PreparedRow> prepared_;
  double volume_velocity_;  ///< g·w [m³/s]; every impulse updates it
};

/// Leaves w in `velocities`.
/// @param volume_velocity  g·v̂ [m³/s]
template <class Mobility>
ContactSolveReport solve(const Mobility& mobility, const VolumeRow* volume, double volume_velocity,
                         double h, std::span<ContactRow> rows, std::vector<Vec3>& velocities,
                         StartImpulses start) {
  ContactSolveReport report;
  Solver solver(mobility, volume, volume_velocity, h, rows, velocities, start);
  if (!rows.empty()) {
    do {
      ++report.sweeps;
    } while (solver.sweep() > kVelocityTolerance && report.sweeps < kMaxSweeps);
  }
  report.volume_impulse = solver.volume_impulse();
  return report;
}

/// The same, and v⁺ = w − W g σ.
template <class Mobility>
ContactSolveReport solve_all(const Mobility& mobility, const VolumeRow* volume, double h,
                             std::span<ContactRow> rows, std::vector<Vec3>& velocities,
                             StartImpulses start) {
  if (volume == nullptr) return solve(mobility, volume, 0, h, rows, velocities, start);
  const auto& gradient = volume->at.gradient;
  double volume_velocity = 0;
  for (std::size_t i = 0; i < gradient.size(); ++i)
    volume_velocity += gradient[i].dot(velocities[i]);
  const auto report = solve(mobility, volume, volume_velocity, h, rows, velocities, start);
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    velocities[i] -= mobility.answer(i, report.volume_impulse, gradient[i]);
  }
  return report;
}

bool has_vanished(const OrganModel& model, const VolumeRow* volume) {
  return volume != nullptr &&
         !(volume->at.denominator > kVanishedDenominator * model.rest_denominator);
}

}  // namespace

ContactSolveReport solve_contacts_and_volume(const OrganModel& model, const VolumeRow* volume,
                                             double h, std::span<ContactRow> rows,
                                             std::vector<Vec3>& velocities, StartImpulses start) {
  const bool vanished = has_vanished(model, volume);
  auto report =
      solve_all(MassMobility(model), vanished ? nullptr : volume, h, rows, velocities, start);
  report.volume_skipped = vanished;
  return report;
}

ContactSolveReport solve_contacts(const OrganModel& model, const VolumeRow* volume,
                                  double volume_velocity, double h, std::span<ContactRow> rows,
                                  std::vector<Vec3>& velocities) {
  const bool vanished = has_vanished(model, volume);
  auto report = solve(MassMobility(model), vanished ? nullptr : volume, volume_velocity, h, rows,
                      velocities, StartImpulses::kToApply);
  report.volume_skipped = vanished;
  return report;
}

ContactSolveReport solve_contacts_and_volume(std::span<const Mat3> mobilities,
                                             const VolumeRow* volume, double h,
                                             std::span<ContactRow> rows,
                                             std::vector<Vec3>& velocities, StartImpulses start) {
  return solve_all(BlockMobility(mobilities), volume, h, rows, velocities, start);
}

}  // namespace palpate::deformation
