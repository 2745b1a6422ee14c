#include "deformation/contact/augmented_contacts.h"

#include <algorithm>
#include <cmath>

namespace palpate::deformation {
namespace {

/// ρ over the effective mass of the contact's nodes, others held: what the last step's impulses
/// leave is soon taken up, and conjugate gradients are not slowed. At 100 they did not find the
/// contacts of a fine mesh.
constexpr double kStiffness = 10;
/// Friction that changes by less than this part of ρ needs no further round.
constexpr double kFrictionTolerance = 0.1;

/// Of the tissue relative to the probe [m/s].
Vec3 relative_velocity(const ContactRow& row, const std::vector<Vec3>& velocities) {
  Vec3 velocity = -row.probe_velocity;
  for (int k = 0; k < 3; ++k) velocity += row.weights[k] * velocities[row.nodes[k]];
  return velocity;
}

/// The part of a vector across a unit direction.
Vec3 across(const Vec3& vector, const Vec3& direction) {
  return vector - direction.dot(vector) * direction;
}

}  // namespace

void AugmentedContacts::begin(std::span<const Mat3> inverse_mass_blocks, std::span<ContactRow> rows,
                              double h, const std::vector<Vec3>& velocities) {
  springs_.assign(rows.size(), {});
  for (std::size_t c = 0; c < rows.size(); ++c) {
    ContactRow& row = rows[c];
    Spring& spring = springs_[c];
    double inverse_mass = 0;
    for (int k = 0; k < 3; ++k) {
      inverse_mass += row.weights[k] * row.weights[k] *
                      row.normal.dot(inverse_mass_blocks[row.nodes[k]] * row.normal);
    }
    if (inverse_mass > 0) spring.stiffness = kStiffness / inverse_mass;
    spring.allowed_approach = std::max(row.gap / h, -kMaxSeparationSpeed);
    if (spring.stiffness == 0) row.normal_impulse = 0;
    const double last = spring.last_pressing = row.normal_impulse;
    spring.last_friction = across(row.tangential_impulse, row.normal);
    spring.friction = press(row, velocities, spring);
    if (last <= 0) continue;
    // As it will be linearised, pulling if need be: the rounds find out.
    spring.presses = true;
    const Vec3 relative = relative_velocity(row, velocities);
    row.normal_impulse =
        last + spring.stiffness * (row.normal.dot(relative) - spring.allowed_approach);
    spring.friction = friction_update(row, relative, last, spring);
  }
}

double AugmentedContacts::press(ContactRow& row, const std::vector<Vec3>& velocities,
                                Spring& spring) const {
  const Vec3 relative = relative_velocity(row, velocities);
  const double approach = row.normal.dot(relative) - spring.allowed_approach;
  row.normal_impulse = std::max(0.0, spring.last_pressing + spring.stiffness * approach);
  spring.presses = row.normal_impulse > 0;
  return friction_update(row, relative, row.normal_impulse, spring);
}

double AugmentedContacts::friction_update(ContactRow& row, const Vec3& relative, double pressing,
                                          const Spring& spring) {
  const Vec3 wanted = spring.last_friction - spring.stiffness * across(relative, row.normal);
  const double limit = row.friction * pressing, norm = wanted.norm();
  const double share = norm > limit ? limit / norm : 1;
  row.tangential_impulse = share * wanted;
  return row.friction > 0 ? share * spring.stiffness : 0;
}

bool AugmentedContacts::update(std::span<ContactRow> rows, const std::vector<Vec3>& velocities) {
  bool changed = false;
  for (std::size_t c = 0; c < rows.size(); ++c) {
    Spring& spring = springs_[c];
    const bool pressed = spring.presses;
    const double friction = press(rows[c], velocities, spring);
    changed |= spring.presses != pressed ||
               std::abs(friction - spring.friction) > kFrictionTolerance * spring.stiffness;
    spring.friction = friction;
  }
  return changed;
}

void AugmentedContacts::go_on(std::span<ContactRow> rows, const std::vector<Vec3>& velocities) {
  for (std::size_t c = 0; c < rows.size(); ++c) {
    springs_[c].last_pressing = rows[c].normal_impulse;
    springs_[c].last_friction = rows[c].tangential_impulse;
  }
  update(rows, velocities);
}

void AugmentedContacts::add_impulses(std::span<const ContactRow> rows,
                                     std::vector<Vec4f>& r) const {
  for (const ContactRow& row : rows) {
    const Vec3 impulse = row.tangential_impulse - row.normal_impulse * row.normal;
    for (int k = 0; k < 3; ++k) r[row.nodes[k]] += wide(row.weights[k] * impulse);
  }
}

void AugmentedContacts::apply(std::span<const ContactRow> rows, const std::vector<Vec4f>& p,
                              std::vector<Vec4f>& out) const {
  for (std::size_t c = 0; c < rows.size(); ++c) {
    if (!springs_[c].presses) continue;
    const ContactRow& row = rows[c];
    Vec4f velocity = Vec4f::Zero();
    for (int k = 0; k < 3; ++k) {
      velocity += static_cast<float>(row.weights[k]) * p[row.nodes[k]];
    }
    const Vec4f normal = wide(row.normal);
    const auto along = static_cast<float>(springs_[c].stiffness - springs_[c].friction);
    const Vec4f answer =
        along * normal.dot(velocity) * normal + static_cast<float>(springs_[c].friction) * velocity;
    for (int k = 0; k < 3; ++k) out[row.nodes[k]] += static_cast<float>(row.weights[k]) * answer;
  }
}

void AugmentedContacts::add_to_diagonal(std::span<const ContactRow> rows,
                                        std::vector<Mat3>& diagonal) const {
  for (std::size_t c = 0; c < rows.size(); ++c) {
    if (!springs_[c].presses) continue;
    const ContactRow& row = rows[c];
    const Mat3 answer =
        (springs_[c].stiffness - springs_[c].friction) * row.normal * row.normal.transpose() +
        springs_[c].friction * Mat3::Identity();
    for (int k = 0; k < 3; ++k) diagonal[row.nodes[k]] += row.weights[k] * row.weights[k] * answer;
  }
}

}  // namespace palpate::deformation
