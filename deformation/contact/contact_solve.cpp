#include "deformation/contact/contact_solve.h"

#include <algorithm>
#include <cmath>

#include "deformation/contact/gauss_seidel.h"
#include "deformation/contact/independent_contacts.h"

namespace palpate::deformation {
namespace {

/// At least this part of a contact's inverse mass is kept when the volume takes freedom from
/// it: a contact that holds the whole organ could otherwise not be moved at all.
constexpr double kLeastMobility = 1e-3;
constexpr int kMaxSweeps = 60;
constexpr int kNewtonSweeps = 10;
constexpr double kLeastSlope = 0.05;  ///< of gᵀWg: contacts that hold nearly all of the surface

/// A row with what Gauss–Seidel needs at every visit.
struct PreparedRow {
  double normal_inverse_mass = 0;      ///< Σ b² W along n with σ held or eliminated [1/kg]
  double tangential_inverse_mass = 0;  ///< Σ b² W across n, the most of it [1/kg]
  double normal_mass = 0, tangential_mass = 0;  ///< one over these [kg]
  std::array<Vec3, 3> normal_answers;           ///< b W n of its nodes [1/kg]
  Vec3 volume_coupling = Vec3::Zero();          ///< Σ b W g [m²/kg]
  double normal_coupling = 0;                   ///< n·Σ b W g
  double sigma_per_impulse = 0;  ///< that over gᵀWg, of rows that eliminate σ [1/m²]
  double volume_share = 0;       ///< what of gᵀWg the row takes while closed [m⁴/kg]
  double allowed_approach = 0;   ///< n·v_c + gap/h, or less the separation speed [m/s]
  Yielding yielding;
  int first_node = 0, last_node = 2;  ///< of the row's three, those it acts on
  bool friction_is_kept = false;      ///< but for what leaves the cone
};

template <class InverseMass>
class Solver {
 public:
  Solver(const InverseMass& inverse_mass, const VolumeRow* volume, double volume_velocity, double h,
         std::span<ContactRow> rows, std::vector<Vec3>& velocities, WarmStart start)
      : inverse_mass_(inverse_mass),
        volume_(volume),
        rows_(rows),
        velocities_(velocities),
        volume_velocity_(volume_velocity),
        per_denominator_(volume == nullptr ? 0 : 1 / volume->at.denominator) {
    sigma_is_held_ = std::all_of(rows.begin(), rows.end(),
                                 [](const ContactRow& row) { return only_node(row) >= 0; });
    prepared_.resize(rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) {
      prepare(rows[r], h, prepared_[r]);
      prepared_[r].friction_is_kept =
          start == WarmStart::kFrictionKept && rows[r].normal_impulse > 0;
    }
    for (std::size_t r = 0; start == WarmStart::kToApply && r < rows.size(); ++r) {
      take_guess(rows[r]);
      const Vec3 impulse = rows[r].tangential_impulse - rows[r].normal_impulse * rows[r].normal;
      add_impulse(r, impulse, prepared_[r].volume_coupling.dot(impulse));
    }
    sigma_ = volume_impulse();
  }

  /// One visit of every contact; the largest change of a contact velocity [m/s].
  double sweep() {
    const double change = visit_all(
        rows_, prepared_, [this](std::size_t r) { return relax_normal(r); },
        [this](std::size_t r) { return relax_friction(r); });
    ++sweeps_;
    return volume_ != nullptr && sigma_is_held_ ? std::max(change, refresh_sigma()) : change;
  }

  int sweeps() const { return sweeps_; }
  /// σ that meets the volume exactly, whatever the contacts' impulses are.
  double volume_impulse() const {
    return volume_ == nullptr ? 0 : (volume_->rate + volume_velocity_) / volume_->at.denominator;
  }

 private:
  void prepare(const ContactRow& row, double h, PreparedRow& prepared) {
    const auto [along, across] = inverse_mass_.along_and_across(row);
    const int only = only_node(row);
    if (only >= 0) prepared.first_node = prepared.last_node = only;
    if (volume_ != nullptr) {
      for (int k = 0; k < 3; ++k) {
        if (row.weights[k] == 0) continue;
        const std::uint32_t node = row.nodes[k];
        prepared.volume_coupling +=
            inverse_mass_.apply(node, row.weights[k] * volume_->at.gradient[node]);
      }
      const double coupling = row.normal.dot(prepared.volume_coupling);
      prepared.normal_coupling = coupling;
      prepared.sigma_per_impulse = sigma_is_held_ ? 0 : coupling * per_denominator_;
      prepared.volume_share = along > 0 ? coupling * coupling / along : 0;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 share = row.weights[static_cast<int>(k)] * row.normal;
      prepared.normal_answers[k] = inverse_mass_.apply(row.nodes[k], share);
    }
    prepared.normal_inverse_mass = along;
    if (volume_ != nullptr && !sigma_is_held_) {
      prepared.normal_inverse_mass *=
          std::max(1 - prepared.volume_share / volume_->at.denominator, kLeastMobility);
    }
    prepared.tangential_inverse_mass = across;
    prepared.normal_mass = 1 / prepared.normal_inverse_mass;
    prepared.tangential_mass = 1 / across;
    prepared.yielding = yielding_of(row, h);
    prepared.allowed_approach = allowed_approach(row, h) + row.normal.dot(row.probe_velocity);
  }

  /// Newton on the volume's one equation, F(σ) = rate + g·w(σ) − gᵀWg σ, piecewise linear in σ
  /// while every row is solved for it: closed rows take their share of the slope. After some
  /// steps the full slope, which is safe and slow. @returns the largest change of a velocity [m/s]
  double refresh_sigma() {
    const double denominator = volume_->at.denominator;
    double slope = denominator, coupling = 0;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      if (rows_[r].normal_impulse <= 0) continue;
      if (sweeps_ <= kNewtonSweeps) slope -= prepared_[r].volume_share;
      coupling = std::max(coupling, prepared_[r].volume_coupling.squaredNorm());
    }
    slope = std::max(slope, kLeastSlope * denominator);
    const double change = (volume_->rate + volume_velocity_ - denominator * sigma_) / slope;
    sigma_ += change;
    return std::abs(change) * std::sqrt(coupling);
  }

  /// Velocity of the tissue at a contact, without σ [m/s].
  Vec3 tissue_velocity(std::size_t r) const {
    const ContactRow& row = rows_[r];
    Vec3 velocity = Vec3::Zero();
    for (int k = prepared_[r].first_node; k <= prepared_[r].last_node; ++k) {
      velocity += row.weights[k] * velocities_[row.nodes[k]];
    }
    return velocity;
  }

  /// @param coupling  of the impulse with the volume
  void add_impulse(std::size_t r, const Vec3& impulse, double coupling) {
    const ContactRow& row = rows_[r];
    for (int k = prepared_[r].first_node; k <= prepared_[r].last_node; ++k) {
      velocities_[row.nodes[k]] += inverse_mass_.apply(row.nodes[k], row.weights[k] * impulse);
    }
    couple(coupling);
  }

  /// @param impulse  along the normal [N·s]
  void add_normal_impulse(std::size_t r, double impulse) {
    const PreparedRow& prepared = prepared_[r];
    for (int k = prepared.first_node; k <= prepared.last_node; ++k) {
      const auto of_row = static_cast<std::size_t>(k);
      velocities_[rows_[r].nodes[of_row]] += impulse * prepared.normal_answers[of_row];
    }
    volume_velocity_ += impulse * prepared.normal_coupling;
    sigma_ += impulse * prepared.sigma_per_impulse;
  }

  void couple(double coupling) {
    volume_velocity_ += coupling;
    if (!sigma_is_held_) sigma_ += coupling * per_denominator_;
  }

  double relax_normal(std::size_t r) {
    ContactRow& row = rows_[r];
    const PreparedRow& prepared = prepared_[r];
    // σ last: each visit waits for the one before to change it.
    const double opening = prepared.allowed_approach - row.normal.dot(tissue_velocity(r));
    const double separation = opening + sigma_ * prepared.normal_coupling;
    const double change = press(row, separation, prepared.normal_mass, prepared.yielding);
    if (change == 0) return 0;
    add_normal_impulse(r, -change);
    return std::abs(change) * prepared.normal_inverse_mass;
  }

  double relax_friction(std::size_t r) {
    ContactRow& row = rows_[r];
    if (!may_rub(row)) return 0;
    if (prepared_[r].friction_is_kept) return cut_friction(r);
    const Vec3 velocity =
        tissue_velocity(r) - row.probe_velocity - sigma_ * prepared_[r].volume_coupling;
    const Vec3 change = rub(row, velocity, prepared_[r].tangential_mass);
    add_impulse(r, change, prepared_[r].volume_coupling.dot(change));
    return change.norm() * prepared_[r].tangential_inverse_mass;
  }

  double cut_friction(std::size_t r) {
    const Vec3 before = rows_[r].tangential_impulse;
    if (!clamp_to_cone(rows_[r])) return 0;
    const Vec3 change = rows_[r].tangential_impulse - before;
    add_impulse(r, change, prepared_[r].volume_coupling.dot(change));
    return change.norm() * prepared_[r].tangential_inverse_mass;
  }

  const InverseMass& inverse_mass_;
  const VolumeRow* volume_;
  std::span<ContactRow> rows_;
  std::vector<Vec3>& velocities_;
  std::vector<PreparedRow> prepared_;
  double volume_velocity_;  ///< g·w [m³/s]; every impulse updates it
  double per_denominator_;  ///< 1/gᵀWg [kg/m⁴]; 0: no volume
  /// Whether σ stays as it is during a sweep. Rows that act on one node each are independent but
  /// for σ: then Newton on σ needs a few sweeps where elimination, which couples all, needs many.
  bool sigma_is_held_ = false;
  double sigma_ = 0;  ///< [Pa·s]
  int sweeps_ = 0;
};

/// Leaves w in `velocities`.
/// @param volume_velocity  g·v̂ [m³/s]
template <class InverseMass>
ContactSolveReport solve(const InverseMass& inverse_mass, const VolumeRow* volume,
                         double volume_velocity, double h, std::span<ContactRow> rows,
                         std::vector<Vec3>& velocities, WarmStart start,
                         int most_sweeps = kMaxSweeps) {
  ContactSolveReport report;
  if (rows.empty()) {
    if (volume != nullptr) {
      report.volume_impulse = (volume->rate + volume_velocity) / volume->at.denominator;
    }
    return report;
  }
  if (auto contacts = IndependentContacts<InverseMass>::take(inverse_mass, volume, h, rows,
                                                             velocities, start)) {
    if (volume != nullptr) report.volume_impulse = contacts->solve_volume(*volume, volume_velocity);
    contacts->apply(inverse_mass, start, rows, velocities);
    report.sweeps = contacts->steps();
    return report;
  }
  Solver solver(inverse_mass, volume, volume_velocity, h, rows, velocities, start);
  while (solver.sweep() > kContactVelocityTolerance && solver.sweeps() < most_sweeps) {
  }
  report.sweeps = solver.sweeps();
  report.volume_impulse = solver.volume_impulse();
  return report;
}

/// The same, and v⁺ = w − W g σ.
template <class InverseMass>
ContactSolveReport solve_all(const InverseMass& inverse_mass, const VolumeRow* volume, double h,
                             std::span<ContactRow> rows, std::vector<Vec3>& velocities,
                             WarmStart start) {
  if (volume == nullptr) return solve(inverse_mass, volume, 0, h, rows, velocities, start);
  const auto& gradient = volume->at.gradient;
  double volume_velocity = 0;
  for (std::size_t i = 0; i < gradient.size(); ++i)
    volume_velocity += gradient[i].dot(velocities[i]);
  const auto report = solve(inverse_mass, volume, volume_velocity, h, rows, velocities, start);
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    velocities[i] -= inverse_mass.apply(i, report.volume_impulse * gradient[i]);
  }
  return report;
}

bool has_vanished(const Body& body, const VolumeRow* volume) {
  return volume != nullptr &&
         !(volume->at.denominator > kVanishedDenominator * body.rest_denominator);
}

}  // namespace

double excess_depth(const Body& body, const ContactRow& row, double h,
                    std::span<const Vec3> velocities) {
  bool moves = false;
  Vec3 velocity = -row.probe_velocity;
  for (int k = 0; k < 3; ++k) {
    moves |= row.weights[k] > 0 && body.inverse_masses[row.nodes[k]] > 0;
    velocity += row.weights[k] * velocities[row.nodes[k]];
  }
  if (!moves) return 0;
  const double excess = h * (row.normal.dot(velocity) - allowed_approach(row, h));
  if (!(row.yielding > 0)) return excess;
  const double yielded = row.yielding * row.normal_impulse / h;
  return std::min(excess, h * row.normal.dot(velocity) - row.full_gap - yielded);
}

ContactSolveReport solve_contacts_and_volume(const Body& body, const VolumeRow* volume, double h,
                                             std::span<ContactRow> rows,
                                             std::vector<Vec3>& velocities, WarmStart start) {
  const bool vanished = has_vanished(body, volume);
  auto report =
      solve_all(NodeInverseMass(body), vanished ? nullptr : volume, h, rows, velocities, start);
  report.volume_skipped = vanished;
  return report;
}

ContactSolveReport solve_contacts(const Body& body, const VolumeRow* volume, double volume_velocity,
                                  double h, std::span<ContactRow> rows,
                                  std::vector<Vec3>& velocities, WarmStart start) {
  const bool vanished = has_vanished(body, volume);
  auto report = solve(NodeInverseMass(body), vanished ? nullptr : volume, volume_velocity, h, rows,
                      velocities, start);
  report.volume_skipped = vanished;
  return report;
}

ContactSolveReport solve_contacts(std::span<const Mat3> inverse_mass_blocks,
                                  const VolumeRow* volume, double volume_velocity, double h,
                                  std::span<ContactRow> rows, std::vector<Vec3>& velocities,
                                  WarmStart start, int most_sweeps) {
  return solve(BlockInverseMass(inverse_mass_blocks), volume, volume_velocity, h, rows, velocities,
               start, most_sweeps);
}

}  // namespace palpate::deformation
