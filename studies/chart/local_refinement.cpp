#include "studies/chart/local_refinement.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace palpate::chart {
namespace {

using geometry::Triangle;
using geometry::TriangleSurface;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edge_of(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }

/// Of equal ones, both triangles of an edge choose the same.
Edge longest_edge(const TriangleSurface& surface, const Triangle& triangle) {
  std::tuple<double, Edge> longest{-1, {}};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto a = triangle[k], b = triangle[(k + 1) % 3];
    const double length = (surface.nodes[a] - surface.nodes[b]).squaredNorm();
    longest = std::max(longest, {length, edge_of(a, b)});
  }
  return std::get<Edge>(longest);
}

/// Edges to halve: what is too long, and the longest edge of each triangle that loses another.
template <class TooLong>
std::set<Edge> edges_to_halve(const TriangleSurface& surface, const TooLong& too_long) {
  std::set<Edge> marked;
  for (bool more = true; more;) {
    more = false;
    for (const Triangle& triangle : surface.triangles) {
      bool cut = false;
      for (std::size_t k = 0; k < 3; ++k) {
        const Edge edge = edge_of(triangle[k], triangle[(k + 1) % 3]);
        cut = cut || too_long(edge) || marked.count(edge) > 0;
      }
      if (cut) more |= marked.insert(longest_edge(surface, triangle)).second;
    }
  }
  return marked;
}

/// Halves the triangle at its longest edge, then its parts at their marked edges.
void cut(const TriangleSurface& surface, const Triangle& triangle,
         const std::map<Edge, std::uint32_t>& middles, std::vector<Triangle>& parts) {
  const Edge longest = longest_edge(surface, triangle);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto a = triangle[k], b = triangle[(k + 1) % 3], c = triangle[(k + 2) % 3];
    const auto middle = middles.find(edge_of(a, b));
    if (middle == middles.end() || edge_of(a, b) != longest) continue;
    const auto m = middle->second;
    for (const auto& [p, q, r] : {Triangle{a, m, c}, Triangle{m, b, c}}) {
      // Of the old edges a part keeps one: q–r or r–p.
      const Edge kept = q == m ? edge_of(r, p) : edge_of(q, r);
      const auto at = middles.find(kept);
      if (at == middles.end()) {
        parts.push_back({p, q, r});
      } else if (q == m) {
        parts.insert(parts.end(), {Triangle{p, q, at->second}, Triangle{at->second, q, r}});
      } else {
        parts.insert(parts.end(), {Triangle{p, q, at->second}, Triangle{p, at->second, r}});
      }
    }
    return;
  }
  parts.push_back(triangle);
}

}  // namespace

TriangleSurface refine_around(TriangleSurface surface, const Vec3& centre, double finest,
                              double growth) {
  const auto too_long = [&](const Edge& edge) {
    const Vec3 &a = surface.nodes[edge.first], &b = surface.nodes[edge.second];
    return (a - b).norm() > finest + growth * ((a + b) / 2 - centre).norm();
  };
  for (auto marked = edges_to_halve(surface, too_long); !marked.empty();
       marked = edges_to_halve(surface, too_long)) {
    std::map<Edge, std::uint32_t> middles;
    for (const Edge& edge : marked) {
      middles[edge] = static_cast<std::uint32_t>(surface.nodes.size());
      surface.nodes.push_back((surface.nodes[edge.first] + surface.nodes[edge.second]) / 2);
    }
    std::vector<Triangle> parts;
    for (const Triangle& triangle : surface.triangles) cut(surface, triangle, middles, parts);
    surface.triangles = std::move(parts);
  }
  return surface;
}

}  // namespace palpate::chart
