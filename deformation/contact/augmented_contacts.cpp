#include "deformation/contact/augmented_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::deformation {
namespace {

/// ρ over the effective mass of the contact's nodes, others held: what the last step's impulses
/// leave is soon taken up, and conjugate gradients are not slowed. At 100 they did not find the
/// contacts of a fine mesh.
constexpr double kStiffness = 10;
/// The same where the contact did not press in the step before: nothing remembered bears a part.
constexpr double kStiffnessWhenNew = 15;
/// Friction that changes by less than this part of ρ is no change.
constexpr double kFrictionTolerance = 0.1;
/// A step ends where the energy falls by less than this part of how it fell at first; pieces are
/// few, so that more steps than these are never seen.
constexpr double kLevel = 1e-4;
constexpr int kMostPieces = 20;

/// The part of a vector across a unit direction.
Vec3 across(const Vec3& vector, const Vec3& direction) {
  return vector - direction.dot(vector) * direction;
}

}  // namespace

AugmentedContacts::Impulse AugmentedContacts::normal_at(const ContactRow& row, const Spring& spring,
                                                        const Vec3& relative) {
  const double approach = row.normal.dot(relative) - spring.allowed_approach;
  Impulse impulse{spring.last_pressing + spring.stiffness * approach, spring.stiffness};
  if (const double yields = spring.stiffness * spring.yielding.inverse_mass; yields > 0) {
    const double more = spring.stiffness * spring.yielding.withheld;
    const Impulse yielding{(impulse.normal + more) / (1 + yields), spring.stiffness / (1 + yields)};
    if (yielding.normal < impulse.normal) impulse = yielding;
  }
  return impulse.normal > 0 ? impulse : Impulse{};
}

AugmentedContacts::Impulse AugmentedContacts::impulse_at(const ContactRow& row,
                                                         const Spring& spring,
                                                         const Vec3& relative) {
  Impulse impulse = normal_at(row, spring, relative);
  if (!(spring.bound > 0)) return impulse;
  const Vec3 wanted = spring.last_friction - spring.stiffness * across(relative, row.normal);
  const double norm = wanted.norm();
  const double share = norm > spring.bound ? spring.bound / norm : 1;
  impulse.friction = share * wanted;
  impulse.sliding = share * spring.stiffness;
  return impulse;
}

void AugmentedContacts::press(ContactRow& row, Spring& spring) {
  spring.bound = row.friction * normal_at(row, spring, spring.relative).normal;
  const Impulse now = impulse_at(row, spring, spring.relative);
  row.normal_impulse = now.normal;
  row.tangential_impulse = now.friction;
  spring.pressing = now.pressing;
  spring.friction = now.sliding;
}

void AugmentedContacts::begin(std::span<const Mat3> inverse_mass_blocks, std::span<ContactRow> rows,
                              double h, const std::vector<Vec3>& velocities) {
  springs_.assign(rows.size(), {});
  for (std::size_t c = 0; c < rows.size(); ++c) {
    ContactRow& row = rows[c];
    Spring& spring = springs_[c];
    double inverse_mass = 0;
    spring.relative = -row.probe_velocity;
    for (int k = 0; k < 3; ++k) {
      inverse_mass += row.weights[k] * row.weights[k] *
                      row.normal.dot(inverse_mass_blocks[row.nodes[k]] * row.normal);
      spring.relative += row.weights[k] * velocities[row.nodes[k]];
    }
    spring.allowed_approach = palpate::deformation::allowed_approach(row, h);
    spring.yielding = yielding_of(row, h);
    if (inverse_mass > 0) {
      const bool is_new = !(row.normal_impulse > 0);
      spring.stiffness = (is_new ? kStiffnessWhenNew : kStiffness) / inverse_mass;
      spring.last_pressing = row.normal_impulse;
      spring.last_friction = across(row.tangential_impulse, row.normal);
    }
    press(row, spring);
  }
}

void AugmentedContacts::go_on(std::span<ContactRow> rows) {
  for (std::size_t c = 0; c < rows.size(); ++c) {
    springs_[c].last_pressing = rows[c].normal_impulse;
    springs_[c].last_friction = rows[c].tangential_impulse;
    press(rows[c], springs_[c]);
  }
}

void AugmentedContacts::set_direction(std::span<const ContactRow> rows,
                                      const std::vector<Vec4f>& p) {
  for (std::size_t c = 0; c < rows.size(); ++c) {
    Vec3 direction = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      direction += rows[c].weights[k] * p[rows[c].nodes[k]].head<3>().cast<double>();
    }
    springs_[c].direction = direction;
  }
}

/// Newton on the slope of the energy along p, which rises piece by piece, between what is known to
/// be too short and too long.
double AugmentedContacts::step_length(std::span<const ContactRow> rows, double descent,
                                      double curvature) const {
  double shortest = 0, longest = std::numeric_limits<double>::infinity(), length = 0;
  for (int piece = 0; piece < kMostPieces; ++piece) {
    double slope = length * curvature - descent, rise = curvature;
    for (std::size_t c = 0; c < rows.size(); ++c) {
      const Spring& spring = springs_[c];
      const Vec3 &n = rows[c].normal, &p = spring.direction;
      const Impulse at = impulse_at(rows[c], spring, spring.relative + length * p);
      const double along = n.dot(p);
      slope += (at.normal - rows[c].normal_impulse) * along -
               (at.friction - rows[c].tangential_impulse).dot(p);
      rise += at.pressing * along * along;
      rise += at.sliding * across(p, n).squaredNorm();
    }
    if (std::abs(slope) <= kLevel * descent) break;
    (slope < 0 ? shortest : longest) = length;
    length -= slope / rise;
    if (!(length > shortest && length < longest)) length = (shortest + longest) / 2;
  }
  return length;
}

bool AugmentedContacts::advance(std::span<ContactRow> rows, double length,
                                std::vector<Vec4f>& product) {
  bool changed = false;
  for (std::size_t c = 0; c < rows.size(); ++c) {
    ContactRow& row = rows[c];
    Spring& spring = springs_[c];
    const double pressing = spring.pressing;
    const double friction = spring.friction;
    const Vec3 before = row.tangential_impulse - row.normal_impulse * row.normal;
    spring.relative += length * spring.direction;
    press(row, spring);
    changed |= spring.pressing != pressing ||
               std::abs(spring.friction - friction) > kFrictionTolerance * spring.stiffness;
    if (pressing == 0 && spring.pressing == 0) continue;
    const Vec3 lost = before - row.tangential_impulse + row.normal_impulse * row.normal;
    for (int k = 0; k < 3; ++k) product[row.nodes[k]] += wide(row.weights[k] / length * lost);
  }
  return changed;
}

void AugmentedContacts::add_impulses(std::span<const ContactRow> rows,
                                     std::vector<Vec4f>& r) const {
  for (const ContactRow& row : rows) {
    const Vec3 impulse = row.tangential_impulse - row.normal_impulse * row.normal;
    for (int k = 0; k < 3; ++k) r[row.nodes[k]] += wide(row.weights[k] * impulse);
  }
}

void AugmentedContacts::add_to_diagonal(std::span<const ContactRow> rows,
                                        std::vector<Mat3>& diagonal) const {
  for (std::size_t c = 0; c < rows.size(); ++c) {
    if (springs_[c].pressing == 0) continue;
    const ContactRow& row = rows[c];
    const Mat3 answer =
        (springs_[c].pressing - springs_[c].friction) * row.normal * row.normal.transpose() +
        springs_[c].friction * Mat3::Identity();
    for (int k = 0; k < 3; ++k) diagonal[row.nodes[k]] += row.weights[k] * row.weights[k] * answer;
  }
}

}  // namespace palpate::deformation
