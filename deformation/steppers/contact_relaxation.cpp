#include "deformation/steppers/contact_relaxation.h"

#include <Eigen/LU>
#include <algorithm>

#include "deformation/steppers/organ_dynamics.h"

namespace palpate::deformation {
namespace {

/// Of r·W r: what is left is a hundredth of the change.
constexpr double kEnough = 1e-4;

}  // namespace

ContactRelaxation::ContactRelaxation(const OrganModel& model)
    : model_(model), neighbours_(model, {}), springs_(model.network(), model.node_count()) {}

bool ContactRelaxation::grow(double h, const std::vector<Vec3>& positions,
                             std::span<const Mat3> diagonal, std::span<const ContactRow> rows) {
  std::vector<std::uint32_t> touched;
  for (const ContactRow& row : rows) {
    for (int k = 0; k < 3; ++k) {
      if (row.weights[k] != 0) touched.push_back(row.nodes[k]);
    }
  }
  std::ranges::sort(touched);
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  if (touched.empty() || touched.size() > kNodes) return false;
  Vec3 centre = Vec3::Zero();
  double mass = 0, whole = 0;
  for (const std::uint32_t node : touched) {
    centre += positions[node] / static_cast<double>(touched.size());
    mass += 3 * (1 + h * model_.drag) * model_.masses[node];
    whole += diagonal[node].trace();
  }
  const double edges = edges_in_reach(whole / mass - 1);
  if (edges < kEdges) return false;
  const std::size_t reach = nodes_in_reach(touched.size(), edges);
  grow_patch(model_, neighbours_, positions, touched, centre, std::min(reach, kNodes), patch_);
  return !patch_.nodes.empty();
}

bool ContactRelaxation::solve(double h, const std::vector<Vec3>& positions,
                              std::span<const Mat3> diagonal, const std::vector<Vec3>& residual,
                              std::span<ContactRow> rows) {
  if (!grow(h, positions, diagonal, rows)) return false;
  springs_.assemble(positions, model_.masses, patch_, {1 + h * model_.drag, h, h * h}, matrix_);
  const std::size_t count = patch_.nodes.size();
  inverse_mass_blocks_.assign(count + 1, Mat3::Zero());
  for (auto* buffer : {&residual_, &change_, &projected_, &product_}) {
    buffer->assign(count + 1, Vec4f::Zero());
  }
  double mass = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t node = patch_.nodes[i];
    inverse_mass_blocks_[i] = diagonal[node].inverse();
    residual_[i] = wide(residual[node]);
    mass += model_.masses[node];
  }
  rows_.assign(rows.begin(), rows.end());
  for (ContactRow& row : rows_) {
    for (std::uint32_t& node : row.nodes) {
      const int place = patch_.place(node);
      node = static_cast<std::uint32_t>(place < 0 ? static_cast<int>(count) : place);
    }
  }
  matrix_.end_row();  // of the held node
  projection_.prepare(inverse_mass_blocks_, {}, rows_);
  conjugate_gradients(mass * kNegligibleVelocity * kNegligibleVelocity);
  double no_volume = 0;
  projection_.take_impulses(rows_, no_volume, residual_);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].normal_impulse = rows_[i].normal_impulse;
    rows[i].tangential_impulse = rows_[i].tangential_impulse;
  }
  return true;
}

void ContactRelaxation::conjugate_gradients(double negligible) {
  auto& nodes = matrix_.nodes();
  nodes.resize(residual_.size());
  double descent = projection_.project(residual_, projected_);
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].vector = projected_[i];
  const double enough = std::max(negligible, kEnough * descent);
  for (int k = 0; k < kIterations && descent > enough; ++k) {
    const double last = descent;
    const double step = descent / matrix_.apply(product_);
    descent = projection_.descend(step, nodes, product_, change_, residual_, projected_);
    projection_.turn(descent / last, projected_, nodes);
  }
}

}  // namespace palpate::deformation
