// A solid's mesh that is fine where probes touch it, wherever that is.
//
// Every mesh is made of halves of the same coarse tetrahedra (modules/geometry/bisection.h) and
// follows from the touched places alone: edges at most
//   h(x) = min over places of  edge · s + growth · max(0, |x − centre| − plateau)
// long, s = 1 unless that takes too many nodes: then the least of 2^(k/4), k = 1, 2, …, that does
// not. Without a place it is the coarse mesh. Of quadratic tetrahedra edges are those between
// corners, and nodes in their middles count as others do.
#pragma once

#include <span>
#include <vector>

#include "modules/core/state_archive.h"
#include "modules/geometry/bisection.h"
#include "modules/geometry/organ_shape.h"

namespace palpate::deformation {

/// Where a probe touches, or soon will. At rest, in W.
struct TouchedPlace {
  Vec3 centre = Vec3::Zero();  ///< [m]
  double plateau = 0;          ///< edges do not grow up to here from the centre [m]
  double edge = 0;             ///< longest there [m]

  bool operator==(const TouchedPlace&) const = default;
  void exchange(StateArchive& archive) { archive(centre, plateau, edge); }
};

/// A mesh of halves as an organ's shape.
struct RefinedShape {
  geometry::OrganShape shape;
  /// The two nodes of `shape` that each node is the middle of; kNone: a corner of the coarse mesh.
  std::vector<geometry::HalvedMesh::Parents> parents;
  std::vector<std::uint8_t> halvings;  ///< of the tetrahedra, see geometry::HalvedMesh
  bool is_coarser = false;             ///< than was asked for: s > 1
};

class FollowingMesh {
 public:
  /// @param coarse      tetrahedra; quadratic ones stay so
  /// @param most_nodes  of all it may have; the coarse mesh may have more
  FollowingMesh(const geometry::OrganShape& coarse, double growth, std::size_t most_nodes);

  /// The same places give the same shape, bit for bit, whatever was asked for before.
  RefinedShape fine_at(std::span<const TouchedPlace> places);

 private:
  void choose(std::span<const TouchedPlace> places);
  bool choose(std::span<const TouchedPlace> places, int coarsening);

  long corners_and_edges() const;

  geometry::BisectionTree tree_;
  bool is_quadratic_;
  double growth_;
  std::size_t most_nodes_;
  long euler_ = 0;      ///< corners − edges + faces − tetrahedra, the same of every mesh
  int coarsening_ = 0;  ///< k of the last mesh
};

}  // namespace palpate::deformation
