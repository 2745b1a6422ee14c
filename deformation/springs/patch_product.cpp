#include "deformation/springs/patch_product.h"

namespace palpate::deformation {

void PatchProduct::take(const Patch& patch, std::span<const std::uint32_t> slices) {
  patch_ = patch.nodes;
  slices_ = slices;
  nodes_.assign(patch_.size() + 1, WideNode{});
  products_.resize(springs_.nodes().size());
  for (WideNode& node : springs_.nodes()) node.vector.setZero();
}

double PatchProduct::apply(std::vector<Vec4f>& out) {
  auto& all = springs_.nodes();
  for (std::size_t i = 0; i < patch_.size(); ++i) all[patch_[i]].vector = nodes_[i].vector;
  const double dot = springs_.apply(slices_, products_);
  for (std::size_t i = 0; i < patch_.size(); ++i) out[i] = products_[patch_[i]];
  return dot;
}

}  // namespace palpate::deformation
