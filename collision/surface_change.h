// An organ's surface that has other triangles than before: how what is remembered of the one is
// found again on the other.
#pragma once

#include <cstdint>
#include <vector>

#include "collision/organ_surface.h"
#include "modules/geometry/surface_transfer.h"

namespace palpate::collision {

struct SurfaceChange {
  std::uint32_t organ = 0;
  const OrganSurface& before;
  const OrganSurface& after;
  const geometry::SurfaceTransfer& transfer;

  /// The triangle that holds the middle of one.
  std::uint32_t triangle(std::uint32_t of_before) const {
    return transfer.place({of_before, Vec3::Constant(1.0 / 3)}).triangle;
  }
  /// The same node; kNoPlace: it is there no more.
  std::uint32_t node(std::uint32_t of_before) const { return transfer.node(of_before); }
  /// The edge, or the half of it, that holds a place next to its middle.
  std::uint32_t edge(std::uint32_t of_before) const;
};

/// Where the nodes of `to` are while those of `from` are at `positions`, all triangles flat [m].
/// @param back  from the surface of `to` to that of `from`
std::vector<Vec3> carried_positions(const OrganSurface& from, const OrganSurface& to,
                                    const geometry::SurfaceTransfer& back);

}  // namespace palpate::collision
