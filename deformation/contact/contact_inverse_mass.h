// How nodes answer the impulses of contacts: by their mass, or in implicit steps by a matrix each.
#pragma once

#include <array>
#include <cmath>
#include <span>

#include "deformation/contact/contact_solve.h"

namespace palpate::deformation {

/// W = M⁻¹.
class NodeInverseMass {
 public:
  explicit NodeInverseMass(const Body& body) : inverse_masses_(body.inverse_masses) {}

  std::size_t node_count() const { return inverse_masses_.size(); }
  /// W impulse: the velocity that node takes [m/s].
  Vec3 apply(std::size_t node, const Vec3& impulse) const {
    return inverse_masses_[node] * impulse;
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

/// Symmetric 3×3 matrices W.
class BlockInverseMass {
 public:
  explicit BlockInverseMass(std::span<const Mat3> inverse_mass_blocks)
      : inverse_mass_blocks_(inverse_mass_blocks) {}

  std::size_t node_count() const { return inverse_mass_blocks_.size(); }
  Vec3 apply(std::size_t node, const Vec3& impulse) const {
    return inverse_mass_blocks_[node] * impulse;
  }
  std::array<double, 2> along_and_across(const ContactRow& row) const {
    Mat3 sum = Mat3::Zero();
    for (int k = 0; k < 3; ++k) {
      sum += (row.weights[k] * row.weights[k]) * inverse_mass_blocks_[row.nodes[k]];
    }
    const Vec3 t = row.normal.unitOrthogonal(), s = row.normal.cross(t);
    const double tt = t.dot(sum * t), ss = s.dot(sum * s), ts = t.dot(sum * s);
    const double apart = std::sqrt((tt - ss) * (tt - ss) + 4 * ts * ts);  // hypot() is a call
    return {row.normal.dot(sum * row.normal), (tt + ss + apart) / 2};
  }

 private:
  std::span<const Mat3> inverse_mass_blocks_;
};

/// Which of the row's nodes it acts on alone, or -1 if it acts on more than one.
inline int only_node(const ContactRow& row) {
  for (int k = 0; k < 3; ++k) {
    if (row.weights[k] == 1 && row.weights.cwiseAbs().sum() == 1) return k;
  }
  return -1;
}

}  // namespace palpate::deformation
