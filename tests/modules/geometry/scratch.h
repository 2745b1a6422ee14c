// Small surfaces for the tests of this folder.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

#include "modules/geometry/triangle_surface.h"
#include "tests/scratch_folder.h"

namespace palpate::geometry::test {

inline double volume_of(const TriangleSurface& surface) {
  return enclosed_volume(surface.nodes, surface.triangles);
}

/// Both surfaces in one, the second one's indices shifted.
inline TriangleSurface both(TriangleSurface first, const TriangleSurface& second) {
  const auto offset = static_cast<std::uint32_t>(first.nodes.size());
  first.nodes.insert(first.nodes.end(), second.nodes.begin(), second.nodes.end());
  for (const auto& [a, b, c] : second.triangles) {
    first.triangles.push_back({a + offset, b + offset, c + offset});
  }
  return first;
}

inline TriangleSurface moved(TriangleSurface surface, const Vec3& by) {
  for (Vec3& node : surface.nodes) node += by;
  return surface;
}

inline TriangleSurface inside_out(TriangleSurface surface) {
  for (Triangle& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
  return surface;
}

/// Every triangle with nodes of its own, as in an STL file.
inline TriangleSurface exploded(const TriangleSurface& surface) {
  TriangleSurface result;
  for (const Triangle& triangle : surface.triangles) {
    const auto next = static_cast<std::uint32_t>(result.nodes.size());
    for (const std::uint32_t node : triangle) result.nodes.push_back(surface.nodes[node]);
    result.triangles.push_back({next, next + 1, next + 2});
  }
  return result;
}

/// Asserts that `call` throws `Error` and returns its message.
template <typename Error, typename Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  FAIL("nothing was thrown");
  return {};
}

}  // namespace palpate::geometry::test
