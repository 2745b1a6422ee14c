#include "deformation/steppers/contact_relaxation.h"

#include <algorithm>

#include "deformation/linear_algebra/conjugate_gradients.h"
#include "deformation/steppers/organ_dynamics.h"

namespace palpate::deformation {
namespace {

/// Of r·W r: what is left is a hundredth of the change.
constexpr double kEnough = 1e-4;

}  // namespace

ContactRelaxation::ContactRelaxation(const OrganModel& model, SpringHessianProduct& springs,
                                     ChunkRunner* runner)
    : model_(model), springs_(springs), neighbours_(model, {}), product_(springs, runner) {}

bool ContactRelaxation::choose(double h, const std::vector<Vec3>& positions,
                               std::span<const ContactRow> rows) {
  std::vector<std::uint32_t> touched;
  for (const ContactRow& row : rows) {
    for (int k = 0; k < 3; ++k) {
      if (row.weights[k] != 0) touched.push_back(row.nodes[k]);
    }
  }
  std::ranges::sort(touched);
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  if (touched.empty() || touched.size() > kMostTouched) return false;
  Vec3 centre = Vec3::Zero();
  double mass = 0, whole = 0;
  for (const std::uint32_t node : touched) {
    centre += positions[node] / static_cast<double>(touched.size());
    mass += 3 * (1 + h * model_.drag) * model_.masses[node];
    whole += springs_.diagonal()[node].trace();
  }
  const double edges = edges_in_reach(whole / mass - 1);
  if (edges < kEdges) return false;
  // What is touched alone would be as stiff as if all about it stood still.
  const std::size_t most = std::max(kMostInReach, 2 * touched.size());
  const std::size_t reach = std::min(nodes_in_reach(touched.size(), edges), most);
  grow_patch(model_, neighbours_, positions, touched, centre, reach, patch_);
  if (patch_.nodes.empty()) return false;
  springs_.find_slices(patch_.nodes, slices_);
  product_.take(patch_);
  return true;
}

void ContactRelaxation::solve(std::span<const Mat3> inverse_mass_blocks,
                              const std::vector<Vec3>& residual, std::span<ContactRow> rows) {
  const std::size_t count = patch_.nodes.size();
  product_.take_couplings(patch_);
  inverse_mass_blocks_.assign(count + 1, Mat3::Zero());
  for (auto* buffer : {&residual_, &change_, &projected_, &products_}) {
    buffer->assign(count + 1, Vec4f::Zero());
  }
  double mass = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t node = patch_.nodes[i];
    inverse_mass_blocks_[i] = inverse_mass_blocks[node];
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
  projection_.prepare(inverse_mass_blocks_, {}, rows_);
  ProjectedSystem<PatchProduct> system{projection_, product_,   change_,
                                       residual_,   projected_, products_};
  const double negligible = mass * kNegligibleVelocity * kNegligibleVelocity;
  conjugate_gradients(system, kIterations, negligible, kEnough);
  double no_volume = 0;
  projection_.take_impulses(rows_, no_volume, residual_);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].normal_impulse = rows_[i].normal_impulse;
    rows[i].tangential_impulse = rows_[i].tangential_impulse;
  }
}

}  // namespace palpate::deformation
