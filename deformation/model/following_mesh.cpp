#include "deformation/model/following_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate::deformation {
namespace {

/// 2^10 times the edges asked for: the coarse mesh of whatever can be held in a hand.
constexpr int kMostCoarsening = 40;

constexpr std::uint32_t kNone = geometry::HalvedMesh::kNone;

/// Without middle nodes.
geometry::TetMesh mesh_of(const geometry::OrganShape& shape) {
  std::vector<bool> is_middle(shape.node_count(), false);
  for (const auto& middles : shape.edge_nodes) {
    for (const auto node : middles) is_middle[node] = true;
  }
  geometry::TetMesh mesh;
  std::vector<std::uint32_t> numbers(shape.node_count(), kNone);
  for (std::size_t i = 0; i < shape.node_count(); ++i) {
    if (is_middle[i]) continue;
    numbers[i] = static_cast<std::uint32_t>(mesh.nodes.size());
    mesh.nodes.push_back(shape.node(i));
  }
  mesh.tetrahedra = shape.tetrahedra;
  for (auto& corners : mesh.tetrahedra) {
    for (auto& node : corners) node = numbers[node];
  }
  return mesh;
}

/// The same of quadratic tetrahedra: a middle's parents are its edge's ends.
void add_edge_nodes(RefinedShape& refined) {
  geometry::OrganShape quadratic = geometry::with_edge_nodes(refined.shape);
  std::vector<geometry::HalvedMesh::Parents> parents(quadratic.node_count(), {kNone, kNone});
  std::vector<std::uint32_t> numbers(refined.shape.node_count(), kNone);
  for (std::size_t e = 0; e < quadratic.tetrahedra.size(); ++e) {
    const auto& corners = quadratic.tetrahedra[e];
    for (std::size_t k = 0; k < 4; ++k) numbers[refined.shape.tetrahedra[e][k]] = corners[k];
    for (std::size_t k = 0; k < geometry::kTetrahedronEdges.size(); ++k) {
      const auto& [i, j] = geometry::kTetrahedronEdges[k];
      const auto [low, high] =
          std::minmax(corners[static_cast<std::size_t>(i)], corners[static_cast<std::size_t>(j)]);
      parents[quadratic.edge_nodes[e][k]] = {low, high};
    }
  }
  for (std::size_t i = 0; i < refined.parents.size(); ++i) {
    const auto& [a, b] = refined.parents[i];
    if (a == kNone) continue;
    const auto [low, high] = std::minmax(numbers[a], numbers[b]);
    parents[numbers[i]] = {low, high};
  }
  refined.shape = std::move(quadratic);
  refined.parents = std::move(parents);
}

}  // namespace

FollowingMesh::FollowingMesh(const geometry::OrganShape& coarse, double growth,
                             std::size_t most_nodes)
    : tree_(mesh_of(coarse)),
      is_quadratic_(!coarse.edge_nodes.empty()),
      growth_(growth),
      most_nodes_(std::max(most_nodes, coarse.node_count())) {
  if (is_quadratic_) euler_ = corners_and_edges() - static_cast<long>(coarse.node_count());
}

/// Of the mesh that is chosen, by Euler's formula.
long FollowingMesh::corners_and_edges() const {
  return static_cast<long>(2 * tree_.node_count() + tree_.tetrahedron_count() +
                           tree_.boundary_count() / 2) -
         euler_;
}

bool FollowingMesh::choose(std::span<const TouchedPlace> places, int coarsening) {
  const double scale = std::exp2(coarsening / 4.0);
  const auto longest_edge = [&](const Vec3& x) {
    double least = std::numeric_limits<double>::infinity();
    for (const TouchedPlace& place : places) {
      const double beyond = std::max(0.0, (x - place.centre).norm() - place.plateau);
      least = std::min(least, scale * place.edge + growth_ * beyond);
    }
    return least;
  };
  if (!is_quadratic_) return tree_.choose(longest_edge, growth_, most_nodes_);
  // No mesh has fewer than two edges for each corner.
  const std::size_t most_corners = std::max(most_nodes_ / 3, tree_.coarse().nodes.size());
  return tree_.choose(longest_edge, growth_, most_corners) &&
         corners_and_edges() <= static_cast<long>(most_nodes_);
}

/// Longer edges never take more nodes: the least k is found from wherever the search begins.
void FollowingMesh::choose(std::span<const TouchedPlace> places) {
  const bool as_last = coarsening_ == 0
                           ? choose(places, 0)
                           : !choose(places, coarsening_ - 1) && choose(places, coarsening_);
  if (as_last) return;
  int fits = kMostCoarsening, fails = -1;
  while (fits - fails > 1) {
    const int middle = (fits + fails) / 2;
    (choose(places, middle) ? fits : fails) = middle;
  }
  coarsening_ = fits;
  choose(places, coarsening_);
}

RefinedShape FollowingMesh::fine_at(std::span<const TouchedPlace> places) {
  choose(places);
  const geometry::HalvedMesh halved = tree_.mesh();
  RefinedShape refined;
  std::vector<std::uint32_t> numbers;
  refined.shape = geometry::shape_of(halved.mesh, halved.boundary, numbers);
  refined.parents.assign(numbers.size(),
                         {geometry::HalvedMesh::kNone, geometry::HalvedMesh::kNone});
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto& [a, b] = halved.parents[i];
    if (a == geometry::HalvedMesh::kNone) continue;
    const auto [low, high] = std::minmax(numbers[a], numbers[b]);
    refined.parents[numbers[i]] = {low, high};
  }
  refined.halvings = halved.halvings;
  refined.is_coarser = coarsening_ > 0;
  if (is_quadratic_) add_edge_nodes(refined);
  return refined;
}

}  // namespace palpate::deformation
