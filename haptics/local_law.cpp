#include "haptics/local_law.h"

#include <algorithm>
#include <cmath>

#include "modules/core/tolerances.h"
#include "modules/core/vector_checks.h"

namespace palpate::haptics {
namespace {

constexpr double kLeastDistance = 1e-3;  // of a probe's radius
/// Beyond two periods the next law is late, and the tissue's velocity no longer known.
constexpr double kVelocityPeriods = 2;

bool is_number(double x) { return std::isfinite(x) && x >= 0; }

bool is_usable(const LawRow& row) {
  return row.point_P.allFinite() && is_unit(row.normal) && is_number(row.gap) &&
         is_number(row.radius) && row.force.allFinite() && row.normal.dot(row.force) >= 0 &&
         row.velocity.allFinite();
}

/// |W_ij|² ≤ W_ii W_jj, W_ii > 0
bool is_usable(const std::vector<double>& lower, std::size_t directions) {
  constexpr double kRounding = 1 + 1e-9;
  if (lower.size() != directions * (directions + 1) / 2) return false;
  std::array<double, 3 * kMaxLawRows> roots;  // of the diagonal
  for (std::size_t i = 0, at = 0; i < directions; ++i) {
    const double own = lower[at + i];
    if (!(own > 0) || !std::isfinite(own)) return false;
    roots[i] = std::sqrt(own);
    for (std::size_t j = 0; j <= i; ++j, ++at) {
      if (!(std::abs(lower[at]) <= kRounding * roots[i] * roots[j])) return false;
    }
  }
  return true;
}

}  // namespace

bool is_usable(const LocalLaw& law) {
  return is_believable(law.anchor) && is_number(law.anchor_age) && is_number(law.period) &&
         std::isfinite(law.growth) && is_number(law.friction_coefficient) &&
         is_number(law.validity_radius) && law.stiffness.allFinite() &&
         law.rows.size() <= kMaxLawRows &&
         std::ranges::all_of(law.rows, [](const LawRow& row) { return is_usable(row); }) &&
         is_usable(law.compliance, law.directions() * law.rows.size());
}

void LawSolver::take(const LocalLaw& law, double softening) {
  anchor_ = law.anchor;
  longest_ = kVelocityPeriods * law.period;
  growth_ = law.growth;
  half_period_ = law.period / 2;
  friction_ = law.friction_coefficient;
  validity_radius_ = law.validity_radius;
  per_row_ = static_cast<int>(law.directions());
  directions_ = per_row_ * static_cast<int>(law.rows.size());
  for (std::size_t r = 0; r < law.rows.size(); ++r) {
    const LawRow& from = law.rows[r];
    Row& row = rows_[r];
    row.basis = contact_basis(from.normal.normalized());
    const Vec3 arm = law.anchor.rotation * from.point_P;
    row.tissue = law.anchor.position + arm - from.gap * row.basis.col(0);
    row.point_P = law.anchor.rotation.conjugate() * Vec3(arm + from.radius * row.basis.col(0));
    row.velocity = from.velocity;
    row.radius = from.radius;
    for (int k = 0; k < per_row_; ++k) {
      const auto i = r * static_cast<std::size_t>(per_row_) + static_cast<std::size_t>(k);
      forces_[i] = anchor_forces_[i] = row.basis.col(k).dot(from.force);
    }
  }
  for (std::size_t i = 0, at = 0; i < static_cast<std::size_t>(directions_); ++i) {
    for (std::size_t j = 0; j <= i; ++j, ++at) {
      compliance_[i][j] = compliance_[j][i] = law.compliance[at];
    }
  }
  if (softening > 0) soften(softening);
}

void LawSolver::soften(double by) {
  for (int i = 0; i < directions_; ++i) {
    const Vec3 own = axis(i);
    for (int j = 0; j < directions_; ++j) {
      compliance_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] +=
          by * own.dot(axis(j));
    }
  }
}

Vec3 LawSolver::axis(int direction) const {
  return rows_[static_cast<std::size_t>(direction / per_row_)].basis.col(direction % per_row_);
}

LawForce LawSolver::evaluate(const Pose& pose, double since_anchor) {
  LawForce result;
  place_rows(pose, std::clamp(since_anchor, 0.0, longest_), result.beyond_validity);
  while (result.sweeps++ < kMaxSweeps && sweep() > kForceTolerance) {
  }
  for (int i = 0; i < directions_; i += per_row_) {
    const double* const forces = &forces_[static_cast<std::size_t>(i)];
    if (std::all_of(forces, forces + per_row_, [](double force) { return force == 0; })) continue;
    const Row& row = rows_[static_cast<std::size_t>(i / per_row_)];
    const Vec3 surface = pose.rotation * row.point_P - row.radius * row.basis.col(0);
    result.pressing += forces[0] * row.basis.col(0);
    for (int k = 0; k < per_row_; ++k) {
      const Vec3 force = forces[k] * row.basis.col(k);
      result.wrench.force += force;
      result.wrench.torque += surface.cross(force);
    }
  }
  // Numbers too large for doubles must not outlive the pose or law that brought them.
  if (!result.wrench.is_finite()) forces_ = anchor_forces_;
  return result;
}

/// Bases of the rows, and s of every direction with the forces there are.
void LawSolver::place_rows(const Pose& pose, double time, bool& beyond_validity) {
  const Vec3 away = pose.position - anchor_.position;
  beyond_validity = directions_ > 0 && is_longer_than(away, validity_radius_);
  const double grown = std::max(0.0, 1 + growth_ * (time + half_period_));
  const Vec3 origin = anchor_.position + clamp_length(away, validity_radius_);
  for (int i = 0; i < directions_; i += per_row_) {
    Row& row = rows_[static_cast<std::size_t>(i / per_row_)];
    const Vec3 apart = origin + pose.rotation * row.point_P - row.tissue - time * row.velocity;
    const double length = apart.norm();
    // A core at the tissue's very place has no direction from it: the last one stays.
    if (row.radius > 0 && length > kLeastDistance * row.radius) {
      row.basis = turned_basis(row.basis, apart / length);
    }
    double* const distance = &distances_[static_cast<std::size_t>(i)];
    for (int k = 0; k < per_row_; ++k) distance[k] = row.basis.col(k).dot(apart);
    distance[0] -= row.radius;
  }
  // By columns of the symmetric W: sums that do not wait for each other.
  const auto count = static_cast<std::size_t>(directions_);
  for (std::size_t j = 0; j < count; ++j) {
    const double by = forces_[j] - grown * anchor_forces_[j];
    if (by == 0) continue;  // a row that is open, and was
    for (std::size_t k = 0; k < count; ++k) distances_[k] += compliance_[j][k] * by;
  }
}

/// @returns the largest change of a force [N]
double LawSolver::sweep() {
  double largest = 0;
  for (int i = 0; i < directions_; i += per_row_) {
    const auto k = static_cast<std::size_t>(i);
    const double wanted = forces_[k] - distances_[k] / compliance_[k][k];
    const double by = std::max(wanted, 0.0) - forces_[k];
    if (by != 0) change(i, by);
    largest = std::max(largest, std::abs(by));
    if (per_row_ > 1) largest = std::max(largest, relax_friction(i));
  }
  return largest;
}

double LawSolver::relax_friction(int first) {
  const auto n = static_cast<std::size_t>(first), t = n + 1, s = n + 2;
  if (forces_[n] == 0 && forces_[t] == 0 && forces_[s] == 0) return 0;
  const double softest = std::max(compliance_[t][t], compliance_[s][s]);
  double along_t = forces_[t] - distances_[t] / softest;
  double along_s = forces_[s] - distances_[s] / softest;
  const double cone = friction_ * forces_[n],
               length = std::sqrt(along_t * along_t + along_s * along_s);
  if (length > cone) {
    along_t *= cone / length;
    along_s *= cone / length;
  }
  const double by_t = along_t - forces_[t], by_s = along_s - forces_[s];
  if (by_t != 0) change(first + 1, by_t);
  if (by_s != 0) change(first + 2, by_s);
  return std::sqrt(by_t * by_t + by_s * by_s);
}

void LawSolver::change(int direction, double by) {
  const auto k = static_cast<std::size_t>(direction);
  forces_[k] += by;
  for (std::size_t j = 0; j < static_cast<std::size_t>(directions_); ++j) {
    distances_[j] += by * compliance_[k][j];
  }
}

void LawSolver::exchange(StateArchive& archive) {
  archive(anchor_, longest_, growth_, half_period_, friction_, validity_radius_, directions_,
          per_row_);
  const bool fits = (per_row_ == 1 || per_row_ == 3) && directions_ >= 0 &&
                    directions_ % per_row_ == 0 &&
                    directions_ / per_row_ <= static_cast<int>(kMaxLawRows);
  if (!fits) throw InputError("its state is no law");
  const auto count = static_cast<std::size_t>(directions_);
  for (std::size_t i = 0; i < count; ++i) {
    archive(anchor_forces_[i], forces_[i]);
    for (std::size_t k = 0; k < count; ++k) archive(compliance_[i][k]);
  }
  for (std::size_t i = 0; i < count / static_cast<std::size_t>(per_row_); ++i) archive(rows_[i]);
}

double LawSolver::stored_energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(directions_); ++i) {
    if (forces_[i] == 0) continue;
    for (std::size_t j = 0; j < static_cast<std::size_t>(directions_); ++j) {
      if (forces_[j] != 0) sum += forces_[i] * compliance_[i][j] * forces_[j];
    }
  }
  return sum / 2;
}

}  // namespace palpate::haptics
