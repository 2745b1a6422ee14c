#include "deformation/contact/organ_contact_solve.h"

#include <algorithm>

#include "deformation/contact/gauss_seidel.h"
#include "deformation/volume/volume_constraint.h"

namespace palpate::deformation {
namespace {

constexpr int kMaxOrganSweeps = 500;
/// At least this part of a contact's inverse mass is kept when volumes take freedom from it.
constexpr double kLeastOrganMobility = 1e-3;

Vec3 velocity_of(const OrganPlace& place, const TouchedOrgan& organ) {
  Vec3 velocity = Vec3::Zero();
  for (int k = 0; k < 3; ++k) velocity += place.weights[k] * organ.velocities[place.nodes[k]];
  return velocity;
}

/// A row with what Gauss–Seidel needs at every visit.
struct PreparedOrganRow {
  std::array<Vec3, 2> couplings;  ///< Σ ± w W g of the places' organs [m²/kg]
  double normal_inverse_mass = 0, tangential_inverse_mass = 0;  ///< [1/kg]
};

/// The volume of an organ: g·(Σ W impulses) and gᵀWg.
struct VolumeAnswer {
  double velocity = 0, denominator = 0;  ///< [m³/s], [m⁴/kg]; 0: not kept

  double sigma() const { return denominator > 0 ? velocity / denominator : 0; }
};

class OrganSolver {
 public:
  OrganSolver(std::span<OrganContactRow> rows, std::span<TouchedOrgan> organs)
      : rows_(rows), organs_(organs), volumes_(organs.size()), prepared_(rows.size()) {
    for (std::size_t i = 0; i < organs.size(); ++i) {
      const VolumeGradient* volume = organs[i].volume;
      const double least = kVanishedDenominator * organs[i].body->rest_denominator;
      if (volume != nullptr && volume->denominator > least)
        volumes_[i].denominator = volume->denominator;
    }
    for (std::size_t r = 0; r < rows.size(); ++r) {
      prepare(rows[r], prepared_[r]);
      start_from_guess(r);
    }
  }

  /// One visit of every contact; the largest change of a contact velocity [m/s].
  double sweep() {
    return visit_all(
        rows_, prepared_, [this](std::size_t r) { return relax_normal(r); },
        [this](std::size_t r) { return relax_friction(r); });
  }

  void apply_volumes() {
    for (std::size_t i = 0; i < organs_.size(); ++i) {
      TouchedOrgan& organ = organs_[i];
      organ.volume_impulse = volumes_[i].sigma();
      if (organ.volume_impulse == 0) continue;
      for (std::size_t k = 0; k < organ.volume->gradient.size(); ++k) {
        organ.velocities[k] -=
            organ.body->inverse_masses[k] * organ.volume_impulse * organ.volume->gradient[k];
      }
    }
  }

 private:
  double inverse_mass(const OrganPlace& place) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      sum += place.weights[k] * place.weights[k] *
             organs_[place.organ].body->inverse_masses[place.nodes[k]];
    }
    return sum;
  }

  /// Σ w W g
  Vec3 coupling(const OrganPlace& place) const {
    const TouchedOrgan& organ = organs_[place.organ];
    Vec3 sum = Vec3::Zero();
    if (volumes_[place.organ].denominator == 0) return sum;
    for (int k = 0; k < 3; ++k) {
      if (place.weights[k] == 0) continue;
      const std::uint32_t node = place.nodes[k];
      sum += place.weights[k] * organ.body->inverse_masses[node] * organ.volume->gradient[node];
    }
    return sum;
  }

  void prepare(const OrganContactRow& row, PreparedOrganRow& prepared) const {
    const auto& [first, second] = row.places;
    prepared.couplings = {-coupling(first), coupling(second)};
    if (first.organ == second.organ) {
      prepared.couplings[1] += prepared.couplings[0];
      prepared.couplings[0].setZero();
    }
    const double inverse = inverse_mass(first) + inverse_mass(second);
    double held = 0;
    for (int s = 0; s < 2; ++s) {
      const double denominator = volumes_[row.places[s].organ].denominator;
      const double along = row.normal.dot(prepared.couplings[s]);
      if (denominator > 0) held += along * along / denominator;
    }
    prepared.normal_inverse_mass = std::max(inverse - held, kLeastOrganMobility * inverse);
    prepared.tangential_inverse_mass = inverse;
  }

  void start_from_guess(std::size_t r) {
    OrganContactRow& row = rows_[r];
    if (row.applied) return;
    take_guess(row);
    add_impulse(r, row.impulse());
  }

  void add_impulse(std::size_t r, const Vec3& impulse) {
    for (int s = 0; s < 2; ++s) {
      const OrganPlace& place = rows_[r].places[s];
      TouchedOrgan& organ = organs_[place.organ];
      const double sign = s == 0 ? -1 : 1;
      for (int k = 0; k < 3; ++k) {
        if (place.weights[k] == 0) continue;
        organ.velocities[place.nodes[k]] +=
            sign * place.weights[k] * organ.body->inverse_masses[place.nodes[k]] * impulse;
      }
      volumes_[place.organ].velocity += prepared_[r].couplings[s].dot(impulse);
    }
  }

  /// Of the places, with what σ takes.
  Vec3 velocity(std::size_t r) const {
    Vec3 sum = relative_velocity(rows_[r], organs_);
    for (int s = 0; s < 2; ++s) {
      sum -= volumes_[rows_[r].places[s].organ].sigma() * prepared_[r].couplings[s];
    }
    return sum;
  }

  double relax_normal(std::size_t r) {
    OrganContactRow& row = rows_[r];
    const PreparedOrganRow& prepared = prepared_[r];
    const double parting = row.normal.dot(velocity(r)) + row.approach;
    const double change = press(row, parting, 1 / prepared.normal_inverse_mass, row.yielding);
    if (change == 0) return 0;
    add_impulse(r, change * row.normal);
    return std::abs(change) * prepared.normal_inverse_mass;
  }

  double relax_friction(std::size_t r) {
    OrganContactRow& row = rows_[r];
    if (!may_rub(row)) return 0;
    const Vec3 change = rub(row, velocity(r), 1 / prepared_[r].tangential_inverse_mass);
    add_impulse(r, change);
    return change.norm() * prepared_[r].tangential_inverse_mass;
  }

  std::span<OrganContactRow> rows_;
  std::span<TouchedOrgan> organs_;
  std::vector<VolumeAnswer> volumes_;
  std::vector<PreparedOrganRow> prepared_;
};

}  // namespace

Vec3 relative_velocity(const OrganContactRow& row, std::span<const TouchedOrgan> organs) {
  const auto& [first, second] = row.places;
  return velocity_of(second, organs[second.organ]) + row.probe_velocity -
         velocity_of(first, organs[first.organ]);
}

OrganContactRow row_of_probe(std::uint32_t organ, const ContactRow& contact, double h) {
  OrganContactRow row;
  row.places[0] = {organ, contact.nodes, contact.weights};
  row.places[1].organ = organ;
  row.normal = contact.normal;
  row.approach = allowed_approach(contact, h);
  row.yielding = yielding_of(contact, h);
  row.friction = contact.friction;
  row.probe_velocity = contact.probe_velocity;
  row.applied = true;
  row.normal_impulse = contact.normal_impulse;
  row.tangential_impulse = -contact.tangential_impulse;
  return row;
}

void take_impulses(const OrganContactRow& row, ContactRow& contact) {
  contact.normal_impulse = row.normal_impulse;
  contact.tangential_impulse = -row.tangential_impulse;
}

OrganContactReport solve_organ_contacts(std::span<OrganContactRow> rows,
                                        std::span<TouchedOrgan> organs) {
  OrganContactReport report;
  for (TouchedOrgan& organ : organs) organ.volume_impulse = 0;
  if (rows.empty()) return report;
  OrganSolver solver(rows, organs);
  do {
    report.converged = solver.sweep() <= kOrganVelocityTolerance;
    ++report.sweeps;
  } while (!report.converged && report.sweeps < kMaxOrganSweeps);
  solver.apply_volumes();
  return report;
}

}  // namespace palpate::deformation
