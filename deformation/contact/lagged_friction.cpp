#include "deformation/contact/lagged_friction.h"

#include <cmath>

#include "deformation/contact/contact_inverse_mass.h"
#include "deformation/contact/gauss_seidel.h"

namespace palpate::deformation {
namespace {

/// Of the tissue on the probe, across the normal [m/s].
Vec3 sliding_velocity(const ContactRow& row, const std::vector<Vec3>& velocities) {
  Vec3 velocity = -row.probe_velocity;
  for (int k = 0; k < 3; ++k) {
    if (row.weights[k] != 0)
      velocity += row.weights[k] * velocities[row.nodes[static_cast<std::size_t>(k)]];
  }
  return velocity - row.normal * row.normal.dot(velocity);
}

}  // namespace

void LaggedFriction::begin(std::span<const ContactRow> rows) {
  anchors_.clear();
  for (const ContactRow& row : rows) anchors_.push_back(row.tangential_impulse);
}

void LaggedFriction::linearise(std::span<const Mat3> inverse_mass_blocks,
                               const std::vector<Vec3>& velocities, std::span<ContactRow> rows) {
  const BlockInverseMass inverse_mass(inverse_mass_blocks);
  laws_.assign(rows.size(), {});
  for (std::size_t r = 0; r < rows.size(); ++r) {
    ContactRow& row = rows[r];
    row.tangential_impulse.setZero();
    const double across = inverse_mass.along_and_across(row)[1];
    const double cone = row.friction * row.normal_impulse;
    if (!(across > 0) || !(cone > 0)) continue;
    row.tangential_impulse = anchors_[r];
    take_guess(row);
    Law& law = laws_[r];
    law.offset = across * row.tangential_impulse;
    const Vec3 sliding = sliding_velocity(row, velocities);
    const double speed = (sliding - law.offset).norm();
    law.slides = speed > cone * across;
    law.coefficient = law.slides ? cone / speed : 1 / across;
    row.tangential_impulse = law.at(sliding);
  }
}

void LaggedFriction::append_couplings(std::span<const ContactRow> rows,
                                      std::vector<ContactCoupling>& couplings) const {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (laws_[r].coefficient == 0) continue;
    const Vec3 tangent = rows[r].normal.unitOrthogonal();
    for (const Vec3& along : {tangent, rows[r].normal.cross(tangent).eval()}) {
      ContactCoupling& coupling = couplings.emplace_back();
      coupling.nodes = rows[r].nodes;
      for (int k = 0; k < 3; ++k) {
        coupling.arms[static_cast<std::size_t>(k)] =
            wide(std::sqrt(laws_[r].coefficient) * rows[r].weights[k] * along);
      }
    }
  }
}

void LaggedFriction::apply(std::span<const Mat3> inverse_mass_blocks, std::vector<Vec3>& velocities,
                           std::span<ContactRow> rows) const {
  std::vector<Vec3> more(rows.size(), Vec3::Zero());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    ContactRow& row = rows[r];
    if (laws_[r].coefficient == 0) continue;
    const Vec3 linear = laws_[r].at(sliding_velocity(row, velocities));
    row.tangential_impulse = linear;
    const double found = linear.norm();
    if (laws_[r].slides && found > 0) {
      row.tangential_impulse *= row.friction * row.normal_impulse / found;
    }
    clamp_to_cone(row);
    more[r] = row.tangential_impulse - linear;
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t node = rows[r].nodes[static_cast<std::size_t>(k)];
      velocities[node] += inverse_mass_blocks[node] * (rows[r].weights[k] * more[r]);
    }
  }
}

}  // namespace palpate::deformation
