#include "deformation/contact/taylor_hood_contact.h"

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"

namespace palpate::deformation {

namespace {

Vec3 no_longer_than(double most, const Vec3& v) {
  const double length = v.norm();
  return length > most ? Vec3(most / length * v) : v;
}

}  // namespace

TaylorHoodContact::TaylorHoodContact(const Body& body, const TaylorHoodElements& solid)
    : body_(body),
      solid_(solid),
      elements_of_node_(body.node_count()),
      rows_of_element_(solid.element_count()) {
  for (std::size_t e = 0; e < solid.element_count(); ++e) {
    for (const auto node : solid.mesh().elements[e]) elements_of_node_[node].push_back(e);
  }
}

/// The element that has all nodes of a row: they lie on one face.
void TaylorHoodContact::locate(Row& row) const {
  const ContactRow& given = row.given;
  int first = 0;
  while (first < 2 && given.weights[first] == 0) ++first;
  for (const std::size_t e : elements_of_node_[given.nodes[static_cast<std::size_t>(first)]]) {
    const auto& nodes = solid_.mesh().elements[e];
    bool has_all = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = std::find(nodes.begin(), nodes.end(), given.nodes[k]);
      row.local[k] = at - nodes.begin();
      has_all = has_all && (at != nodes.end() || given.weights[static_cast<int>(k)] == 0);
    }
    row.element = e;
    if (has_all) return;
  }
  PALPATE_DEMAND(!"a contact row acts on nodes of one element");
}

Vec3 TaylorHoodContact::point(const Row& row, const std::vector<Vec3>& positions) const {
  Vec3 y = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (row.given.weights[k] != 0) y += row.given.weights[k] * positions[row.given.nodes[k]];
  }
  return y;
}

void TaylorHoodContact::take(std::span<const ContactRow> rows, double h,
                             const std::vector<Vec3>& positions) {
  rows_.clear();
  for (auto& of_element : rows_of_element_) of_element.clear();
  for (const ContactRow& given : rows) {
    Row row{.given = given};
    locate(row);
    for (int k = 0; k < 3; ++k) {
      row.penalty += kPenaltyFactor * given.weights[k] * given.weights[k] *
                     body_.node_stiffness[given.nodes[k]];
    }
    row.start = given.normal.dot(point(row, positions));
    row.multiplier = given.normal_impulse / h;
    row.bound = given.friction * row.multiplier;
    row.friction_multiplier = -given.tangential_impulse / h;
    rows_of_element_[row.element].push_back(rows_.size());
    rows_.push_back(row);
  }
}

void TaylorHoodContact::begin_part(double time, double part, const std::vector<Vec3>& positions) {
  for (Row& row : rows_) {
    const ContactRow& given = row.given;
    const double start = row.start + time * given.normal.dot(given.probe_velocity);
    row.limit = start + std::max(given.gap, -kMaxSeparationSpeed * time);
    row.full_limit = start + given.full_gap;
    row.stuck = point(row, positions) + part * given.probe_velocity;
  }
}

/// Where that is less, as much as fixed nodes give with those that can move.
void TaylorHoodContact::yield(const Row& row, double full_gap, Force& force) {
  const double share = 1 / (1 + row.penalty * row.given.yielding);
  const double normal = share * (row.multiplier - row.penalty * full_gap);
  if (normal >= force.normal) return;
  force.normal = normal;
  force.stiffness = share * row.penalty;
  force.gap = full_gap + row.given.yielding * std::max(0.0, normal);
}

TaylorHoodContact::Force TaylorHoodContact::force(const Row& row,
                                                  const std::vector<Vec3>& positions) const {
  const Vec3 &y = point(row, positions), &n = row.given.normal;
  Force force;
  force.gap = row.limit - n.dot(y);
  force.normal = row.multiplier - row.penalty * force.gap;
  force.stiffness = row.penalty;
  if (row.given.yielding > 0) yield(row, row.full_limit - n.dot(y), force);
  if (force.normal <= 0) force.normal = force.stiffness = 0;
  if (row.bound > 0) {
    const Vec3 sliding = y - row.stuck;
    force.trial =
        row.friction_multiplier + kSlidingPenalty * row.penalty * (sliding - n * n.dot(sliding));
  }
  return force;
}

void TaylorHoodContact::add_impulses(const SolidState& state, double part,
                                     std::span<ContactRow> rows) const {
  PALPATE_DEMAND(rows.size() == rows_.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Force on = force(rows_[r], state.positions);
    rows[r].normal_impulse += part * on.normal;
    // Where bound and force differ a little, the cone has the last word.
    const double most = std::min(rows_[r].bound, rows[r].friction * on.normal);
    rows[r].tangential_impulse -= part * no_longer_than(most, on.trial);
  }
}

void TaylorHoodContact::add_residual(std::size_t element, const SolidState& state,
                                     ElementVector& residual) const {
  for (const std::size_t r : rows_of_element_[element]) {
    const Row& row = rows_[r];
    const Force on = force(row, state.positions);
    const Vec3 total = on.normal * row.given.normal + no_longer_than(row.bound, on.trial);
    for (int k = 0; k < 3; ++k) {
      if (row.given.weights[k] == 0) continue;
      residual.segment<3>(3 * row.local[k]) += row.given.weights[k] * total;
    }
  }
}

void TaylorHoodContact::add_tangent(std::size_t element, const SolidState& state,
                                    ElementMatrix& tangent, bool /*positive*/) const {
  for (const std::size_t r : rows_of_element_[element]) {
    const Row& row = rows_[r];
    const Force on = force(row, state.positions);
    const Mat3 along = row.given.normal * row.given.normal.transpose();
    Mat3 stiffness = on.stiffness * along;
    const double trial = on.trial.norm();
    if (row.bound > 0 && trial <= row.bound) {
      stiffness += kSlidingPenalty * row.penalty * (Mat3::Identity() - along);
    } else if (row.bound > 0) {
      const Vec3 t = on.trial / trial;
      stiffness += kSlidingPenalty * row.penalty * row.bound / trial *
                   (Mat3::Identity() - along - t * t.transpose());
    }
    for (int k = 0; k < 3; ++k) {
      for (int l = 0; l < 3; ++l) {
        const double weight = row.given.weights[k] * row.given.weights[l];
        if (weight == 0) continue;
        tangent.block<3, 3>(3 * row.local[k], 3 * row.local[l]) += weight * stiffness;
      }
    }
  }
}

double TaylorHoodContact::deepest(const SolidState& state) const {
  double deepest = 0;
  for (const Row& row : rows_) deepest = std::max(deepest, -force(row, state.positions).gap);
  return deepest;
}

bool TaylorHoodContact::is_settled(const SolidState& state) const {
  double largest = 0, difference = 0;
  for (const Row& row : rows_) {
    if (row.given.friction == 0) continue;
    const double wanted = row.given.friction * force(row, state.positions).normal;
    largest = std::max({largest, wanted, row.bound});
    difference = std::max(difference, std::abs(wanted - row.bound));
  }
  return difference <= kFrictionTolerance * largest;
}

void TaylorHoodContact::augment(const SolidState& state) {
  for (Row& row : rows_) {
    const Force on = force(row, state.positions);
    row.friction_multiplier = no_longer_than(row.bound, on.trial);
    row.multiplier = on.normal;
    row.bound = row.given.friction * on.normal;
  }
}

}  // namespace palpate::deformation
