// From one triangulation of a surface to another: both divide the same faces at rest, so a place on
// the one is a place on the other.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "modules/core/state_archive.h"
#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// Of each place in `from` where the same stands in `to`, bit for bit; kNoPlace: nowhere.
std::vector<std::uint32_t> same_places(std::span<const Vec3> from, std::span<const Vec3> to);
inline constexpr std::uint32_t kNoPlace = std::numeric_limits<std::uint32_t>::max();

struct PlaceOnSurface {
  std::uint32_t triangle = 0;
  Vec3 weights = Vec3::Zero();  ///< barycentric, ≥ 0, sum 1
};

class SurfaceTransfer {
 public:
  /// Nodes are the same where they rest at the same place, to the bit.
  /// @param from_rest, to_rest  of the surfaces' nodes at least [m]
  /// @param to                  not empty
  SurfaceTransfer(std::span<const Vec3> from_rest, std::span<const Triangle> from,
                  std::span<const Vec3> to_rest, std::span<const Triangle> to);

  std::size_t node_count() const { return nodes_.size(); }          ///< of `from`
  std::size_t triangle_count() const { return triangles_.size(); }  ///< of `from`
  /// The same node; kNoPlace: there is none.
  std::uint32_t node(std::uint32_t of_from) const { return nodes_[of_from]; }
  /// The triangle of the same corners; kNoPlace: there is none.
  std::uint32_t triangle(std::uint32_t of_from) const { return triangles_[of_from]; }
  /// The same place; of a triangle that is there no more, the one that holds it at rest.
  PlaceOnSurface place(const PlaceOnSurface& of_from) const;

  SurfaceTransfer() = default;  ///< to exchange()
  void exchange(StateArchive& archive) {
    archive(from_rest_, to_rest_, from_, to_, nodes_, triangles_, new_);
  }

 private:
  struct New {
    std::uint32_t triangle = 0;
    Vec3 centre = Vec3::Zero();
    double radius = 0;  ///< of a ball about `centre` that holds it [m]
    void exchange(StateArchive& archive) { archive(triangle, centre, radius); }
  };

  std::vector<Vec3> from_rest_, to_rest_;
  std::vector<Triangle> from_, to_;
  std::vector<std::uint32_t> nodes_, triangles_;
  std::vector<New> new_;  ///< triangles of `to` that `from` has not
};

}  // namespace palpate::geometry
