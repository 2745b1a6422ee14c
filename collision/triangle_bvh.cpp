#include "collision/triangle_bvh.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/utility.h>  // fit(), which BVH_model.h uses but does not include

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"

namespace palpate::collision {

struct TriangleBvh::Impl {
  fcl::BVHModel<fcl::AABBd> model;
  std::vector<Vec3> fitted_nodes;  ///< around which the boxes are
  double displacement = 0;         ///< largest distance of a node from there [m]
  double mean_edge = 0;            ///< [m]

  void refit(const std::vector<Vec3>& nodes);
};

TriangleBvh::TriangleBvh(const std::vector<Vec3>& nodes,
                         std::span<const geometry::Triangle> triangles)
    : impl_(std::make_unique<Impl>()) {
  impl_->fitted_nodes = nodes;
  if (triangles.empty()) return;
  std::vector<fcl::Triangle> indices;
  indices.reserve(triangles.size());
  for (const geometry::Triangle& t : triangles) {
    indices.emplace_back(t[0], t[1], t[2]);
    for (int k = 0; k < 3; ++k) {
      impl_->mean_edge += (nodes[t[k]] - nodes[t[(k + 1) % 3]]).norm() / (3.0 * triangles.size());
    }
  }
  auto& model = impl_->model;
  model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(nodes.size()));
  model.addSubModel(nodes, indices);
  PALPATE_DEMAND(model.endModel() == fcl::BVH_OK);
}

TriangleBvh::~TriangleBvh() = default;
TriangleBvh::TriangleBvh(TriangleBvh&&) noexcept = default;
TriangleBvh& TriangleBvh::operator=(TriangleBvh&&) noexcept = default;

void TriangleBvh::Impl::refit(const std::vector<Vec3>& nodes) {
  // This loop takes a third of the time of FCL's own replaceSubModel() with refit. Children come
  // after their parent.
  for (int i = model.getNumBVs() - 1; i >= 0; --i) {
    auto& node = model.getBV(i);
    if (node.isLeaf()) {
      const fcl::Triangle& t = model.tri_indices[node.primitiveId()];
      const Vec3 &a = nodes[t[0]], &b = nodes[t[1]], &c = nodes[t[2]];
      node.bv.min_ = a.cwiseMin(b).cwiseMin(c);
      node.bv.max_ = a.cwiseMax(b).cwiseMax(c);
    } else {
      const auto &left = model.getBV(node.leftChild()).bv,
                 &right = model.getBV(node.rightChild()).bv;
      node.bv.min_ = left.min_.cwiseMin(right.min_);
      node.bv.max_ = left.max_.cwiseMax(right.max_);
    }
  }
  fitted_nodes = nodes;
  displacement = 0;
}

void TriangleBvh::move(const std::vector<Vec3>& nodes) {
  PALPATE_DEMAND(nodes.size() == impl_->fitted_nodes.size());
  double squared = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    squared = std::max(squared, (nodes[i] - impl_->fitted_nodes[i]).squaredNorm());
  }
  impl_->displacement = std::sqrt(squared);
  if (impl_->displacement > impl_->mean_edge) impl_->refit(nodes);
}

Bounds TriangleBvh::bounds() const {
  Bounds bounds;
  if (impl_->model.getNumBVs() == 0) return bounds;
  const auto& root = impl_->model.getBV(0).bv;
  bounds = {root.min_, root.max_};
  bounds.inflate(impl_->displacement);
  return bounds;
}

void TriangleBvh::append_overlapping(const Bounds& box,
                                     std::vector<std::uint32_t>& triangles) const {
  // FCL's own mesh–shape query runs GJK on every leaf; boxes are all that is wanted here.
  const auto& model = impl_->model;
  if (model.getNumBVs() == 0) return;
  Bounds wide = box;
  wide.inflate(impl_->displacement);
  const fcl::AABBd wanted(wide.lower, wide.upper);
  std::vector<int> waiting{0};
  while (!waiting.empty()) {
    const auto& node = model.getBV(waiting.back());
    waiting.pop_back();
    if (!node.bv.overlap(wanted)) continue;
    if (node.isLeaf()) {
      triangles.push_back(static_cast<std::uint32_t>(node.primitiveId()));
    } else {
      waiting.push_back(node.rightChild());
      waiting.push_back(node.leftChild());
    }
  }
}

}  // namespace palpate::collision
