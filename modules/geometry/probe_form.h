// What a probe is, in its own frame P: one of the few solids that searches, contacts and pictures
// know. Each shape that a scene may name comes down to one of them (modules/scene/probe_shape.h).
#pragma once

#include <variant>

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// All within `radius` of the segment from `a` to `b` [m]: a capsule, or a ball if they are equal.
struct RoundedSegment {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  double radius = 0;

  bool is_ball() const { return a == b; }
};
/// About the origin, along the axes.
struct Box {
  Vec3 size = Vec3::Zero();  ///< full extents [m]
};
/// z ≤ 0.
struct HalfSpace {};

/// A surface is closed and oriented outward; none (no nodes) where it was not loaded.
using ProbeForm = std::variant<RoundedSegment, Box, HalfSpace, TriangleSurface>;

/// Surface for pictures [m]. A half-space has no end: it becomes a square patch of `patch_size`
/// about the origin.
TriangleSurface surface_of(const ProbeForm& form, double patch_size);

/// Radius of what it touches with [m]; 0 if it is not small or its shape does not tell.
double tip_radius(const ProbeForm& form);

}  // namespace palpate::geometry
