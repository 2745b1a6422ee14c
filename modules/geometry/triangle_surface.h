// A closed triangle surface and its integral measures.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "modules/core/types.h"

namespace palpate::geometry {

using Triangle = std::array<std::uint32_t, 3>;

struct TriangleSurface {
  std::vector<Vec3> nodes;          ///< [m]
  std::vector<Triangle> triangles;  ///< outward (counter-clockwise seen from outside)
};

/// Enclosed volume [m³]: V = (1/6) Σ x₁·(x₂×x₃), taken about the first node so that a surface far
/// from the origin keeps its digits. Negative if oriented inward. Meaningful if closed.
double enclosed_volume(std::span<const Vec3> nodes, std::span<const Triangle> triangles);

double surface_area(std::span<const Vec3> nodes, std::span<const Triangle> triangles);  ///< [m²]

/// Area-weighted normal (not unit) of one triangle: ½ (b−a)×(c−a) [m²].
Vec3 area_vector(std::span<const Vec3> nodes, const Triangle& triangle);

/// The volume from the x-, y- and z-only forms of the divergence theorem [m³]. They agree iff the
/// surface is closed (leak test).
std::array<double, 3> three_axis_volumes(std::span<const Vec3> nodes,
                                         std::span<const Triangle> triangles);

/// Centroid of the enclosed solid [m].
Vec3 solid_centroid(const TriangleSurface& surface);

/// Unit direction of the longest extent (largest principal component of the nodes). The sign is
/// chosen so that the largest component is positive.
Vec3 dominant_axis(std::span<const Vec3> nodes);

/// Undirected edges, each once, a < b, sorted.
std::vector<std::array<std::uint32_t, 2>> edges_of(std::span<const Triangle> triangles);

/// Mean length of the edges [m]. @param surface  with triangles
double mean_edge_length(const TriangleSurface& surface);

}  // namespace palpate::geometry
