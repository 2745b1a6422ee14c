// The part of an organ's closed surface near a probe's core, reached over shared nodes: what it
// costs follows the part, not the mesh.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "deformation/contact/wall_crossing.h"
#include "deformation/model/body.h"
#include "modules/geometry/closest_points.h"

namespace palpate::deformation {

/// A triangle and where it is nearest to a core.
struct NearTriangle {
  std::uint32_t index = 0;
  geometry::SegmentAndTriangle pair;
  Vec3 away = Vec3::Zero();  ///< unit, from the triangle to the core; zero where they touch
  double facing = 0;         ///< outward normal · away: > 0 where the core sees it from its front
};

class SurfaceWalk {
 public:
  /// @param body  outlives this
  explicit SurfaceWalk(const Body& body);
  const Body& body() const { return body_; }
  /// Of a surface node, ascending.
  std::span<const std::uint32_t> around(std::uint32_t node) const;

  NearTriangle triangle_near(std::uint32_t triangle, const Vec3& a, const Vec3& b,
                             std::span<const Vec3> positions) const;

  /// Of all surface nodes the one nearest to the core a–b: a look at each.
  std::uint32_t nearest_node(const Vec3& a, const Vec3& b, std::span<const Vec3> positions) const;

  /// Downhill from the seed nearest to the core a–b, then all triangles within `reach` [m] that are
  /// connected with where that ends or with a seed, and that one whatever its distance. Ascending.
  void find(const Vec3& a, const Vec3& b, std::span<const Vec3> positions,
            std::span<const std::uint32_t> seeds, double reach, std::vector<NearTriangle>& near);

  /// All triangles within `reach` [m] of the core a–b, connected or not: a look at each. Appended.
  void append_near(const Vec3& a, const Vec3& b, std::span<const Vec3> positions, double reach,
                   std::vector<std::uint32_t>& near) const;

  /// Does the core a–b, longer than a point, lie through a triangle, at a place that nothing fixed
  /// carries (there it would yield)? Looks at those around it that are connected with the seeds.
  bool is_cut(const Vec3& a, const Vec3& b, std::span<const Vec3> positions,
              std::span<const std::uint32_t> seeds, double reach);

  /// The first inward crossing of a point that goes from p0 to p1 while the nodes go from `start`
  /// to `end`, all along straight lines; of triangles connected with the seeds.
  std::optional<WallCrossing> first_crossing(const Vec3& p0, const Vec3& p1,
                                             std::span<const Vec3> start, std::span<const Vec3> end,
                                             std::span<const std::uint32_t> seeds);

  /// The first inward crossing of each triangle by a core's side, over one of its edges; of
  /// triangles connected with the seeds.
  void find_side_crossings(const CoreWay& core, std::span<const Vec3> start,
                           std::span<const Vec3> end, std::span<const std::uint32_t> seeds,
                           std::vector<WallCrossing>& crossings);

 private:
  std::uint32_t nearest_from(const Vec3& a, const Vec3& b, std::span<const Vec3> positions,
                             std::span<const std::uint32_t> seeds);
  /// Of the triangle on the other side of an edge, the corner that is not on it.
  std::uint32_t opposite_of(std::uint32_t p, std::uint32_t q, std::uint32_t triangle) const;
  /// Visits `first` and what is connected with it through triangles that `take` wants.
  template <class Take>
  void flood(std::span<const std::uint32_t> first, const Take& take);

  const Body& body_;
  std::vector<std::uint32_t> first_triangle_, node_triangles_;  ///< of a node, as a list of lists
  // Kept between calls for their memory only.
  std::vector<std::uint32_t> visited_;  ///< the walk that saw a triangle last, by triangle
  std::uint32_t walk_ = 0;
  std::vector<std::uint32_t> waiting_, first_;
};

/// Is the core behind the nearest of the triangles? Of those equally near the one that it sees most
/// squarely tells (that of an edge or corner both sides of which are near).
bool is_behind_nearest(std::span<const NearTriangle> near);

}  // namespace palpate::deformation
