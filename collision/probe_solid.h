// Solid probe shapes as seen by a point: signed distance, entry of a moving point, shadow.
// Everything in the probe's frame P.
#pragma once

#include <memory>
#include <optional>

#include "modules/core/types.h"

namespace palpate::collision {

struct SolidPoint {
  Vec3 point = Vec3::Zero();     ///< nearest on the surface [m]
  Vec3 outward = Vec3::UnitZ();  ///< unit, from the solid; along ±(x − point) off the surface
  double distance = 0;           ///< signed, negative inside [m]
  bool one_sided = false;        ///< the solid has no other side that could be meant
};

struct SolidEntry {
  double time = 0;  ///< fraction of the way
  Vec3 point = Vec3::Zero();
  Vec3 outward = Vec3::UnitZ();  ///< unit normal of the face entered through
};

class ProbeSolid {
 public:
  virtual ~ProbeSolid() = default;

  /// Nearest surface point, exact; nullopt only if it is further away than `within` [m].
  virtual std::optional<SolidPoint> nearest(const Vec3& x, double within) const = 0;
  /// First place where a point moving from `start` to `end` enters; nullopt if it starts inside.
  virtual std::optional<SolidEntry> entry(const Vec3& start, const Vec3& end,
                                          double separation) const = 0;
  /// Does the ray from x along `direction` hit the solid?
  virtual bool shadows(const Vec3& x, const Vec3& direction) const = 0;
};

std::unique_ptr<ProbeSolid> make_half_space();                 ///< z ≤ 0
std::unique_ptr<ProbeSolid> make_box_solid(const Vec3& size);  ///< about the origin [m]

}  // namespace palpate::collision
