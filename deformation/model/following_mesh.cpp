#include "deformation/model/following_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::deformation {
namespace {

/// 2^10 times the edges asked for: the coarse mesh of whatever can be held in a hand.
constexpr int kMostCoarsening = 40;

geometry::TetMesh mesh_of(const geometry::OrganShape& shape) {
  geometry::TetMesh mesh;
  for (std::size_t i = 0; i < shape.node_count(); ++i) mesh.nodes.push_back(shape.node(i));
  mesh.tetrahedra = shape.tetrahedra;
  return mesh;
}

}  // namespace

FollowingMesh::FollowingMesh(const geometry::OrganShape& coarse, double growth,
                             std::size_t most_nodes)
    : tree_(mesh_of(coarse)), growth_(growth), most_nodes_(most_nodes) {}

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
  return tree_.choose(longest_edge, std::max(most_nodes_, tree_.coarse().nodes.size()));
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
  refined.is_coarser = coarsening_ > 0;
  return refined;
}

}  // namespace palpate::deformation
