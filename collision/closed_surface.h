// Inside or outside of an organ, of a point and of a segment, and the wall nearest to a point, by
// its whole closed surface.
//
// The number of times a closed surface winds around p is the number of times a ray from p leaves
// the inside less the number of times it enters it. The ray is parallel to an axis, so the tree's
// boxes that it meets are those overlapping a thin box, and whether it meets a triangle is decided
// by the signs of three determinants in the plane across it. Each determinant belongs to an edge
// and is computed alike for both its triangles; a zero is decided as if p were moved by (ε, ε²).
// So a ray through an edge or a node is counted once, and the number is whole.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "collision/organ_surface.h"

namespace palpate::collision {

class ClosedSurface {
 public:
  /// @param p  in W. @returns whether the surface winds around it; no if p is on it
  bool encloses(const OrganSurface& organ, const Vec3& p);
  /// Where along a segment in W it is inside, as a fraction from a to b: an end, else the middle of
  /// the longest piece between two cuts of the surface that is. Nothing: all of it is outside.
  std::optional<double> encloses_at(const OrganSurface& organ, const Vec3& a, const Vec3& b);
  /// The lowest of the triangles nearest to p; `distance` of it [m].
  std::uint32_t nearest_triangle(const OrganSurface& organ, const Vec3& p, double& distance);

 private:
  void find_cuts(const OrganSurface& organ, const Vec3& a, const Vec3& b);

  // Kept between calls for their memory only.
  std::vector<std::uint32_t> triangles_;
  std::vector<double> block_distances_;  ///< squared [m²]
  std::vector<double> cuts_;
};

}  // namespace palpate::collision
