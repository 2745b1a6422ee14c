// One visit of a contact by projected Gauss–Seidel, whatever its row's places are and whatever
// answers its impulses. A row has `normal`, `normal_impulse` ≥ 0, `tangential_impulse` and
// `friction`.
#pragma once

#include <algorithm>
#include <cmath>

#include "modules/core/types.h"

namespace palpate::deformation {

/// Coulomb: |tangential| ≤ friction · normal.
/// @returns whether it was more
template <class Row>
bool clamp_to_cone(Row& row) {
  const double limit = row.friction * row.normal_impulse;
  const double square = row.tangential_impulse.squaredNorm();
  if (!(square > limit * limit)) return false;
  row.tangential_impulse *= limit / std::sqrt(square);
  return true;
}

/// Start values are only a guess, but must lie in the cone of this row.
template <class Row>
void take_guess(Row& row) {
  row.tangential_impulse -= row.normal * row.normal.dot(row.tangential_impulse);
  clamp_to_cone(row);
}

/// 0 ≤ normal impulse ⊥ separation ≥ 0.
/// @param separation  speed at which it opens [m/s]
/// @param mass        effective, along the normal [kg] > 0: visits wait for each other, and a
///                    division would be a third of one
/// @returns the change of the normal impulse [N·s]
template <class Row>
double press(Row& row, double separation, double mass) {
  if (row.normal_impulse == 0 && separation >= 0) return 0;
  const double wanted = row.normal_impulse - separation * mass;
  const double change = std::max(0.0, wanted) - row.normal_impulse;
  row.normal_impulse += change;
  return change;
}

/// The same where what is fixed yields, too: the less of the two impulses.
/// @param yielding  a Yielding
template <class Row, class Yielding>
double press(Row& row, double separation, double mass, const Yielding& yielding) {
  if (!(yielding.inverse_mass > 0)) return press(row, separation, mass);
  const double before = row.normal_impulse;
  const double parting = separation - yielding.withheld + yielding.inverse_mass * before;
  const double wanted =
      std::min(before - separation * mass, before - parting / (1 / mass + yielding.inverse_mass));
  row.normal_impulse = std::max(0.0, wanted);
  return row.normal_impulse - before;
}

/// Stops what slides, within the cone.
/// @param velocity  of one side to the other; what is along the normal does not matter [m/s]
/// @param mass      effective, across the normal [kg] > 0
/// @returns the change of the tangential impulse [N·s]
template <class Row>
Vec3 rub(Row& row, const Vec3& velocity, double mass) {
  const Vec3 sliding = velocity - row.normal * row.normal.dot(velocity);
  const Vec3 before = row.tangential_impulse;
  row.tangential_impulse -= sliding * mass;
  clamp_to_cone(row);
  return row.tangential_impulse - before;
}

/// Whether rubbing may change anything.
template <class Row>
bool may_rub(const Row& row) {
  return row.normal_impulse != 0 || !row.tangential_impulse.isZero(0);
}

/// One visit of every contact.
/// @param relax_normal, relax_friction  of row r: the change of a contact velocity [m/s]
/// @returns the largest change [m/s]
template <class Rows, class Prepared, class Normal, class Friction>
double visit_all(const Rows& rows, const Prepared& prepared, const Normal& relax_normal,
                 const Friction& relax_friction) {
  double change = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (prepared[r].tangential_inverse_mass == 0) continue;  // all nodes fixed
    change = std::max(change, relax_normal(r));
    if (rows[r].friction > 0) change = std::max(change, relax_friction(r));
  }
  return change;
}

}  // namespace palpate::deformation
