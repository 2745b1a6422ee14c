#include "modules/geometry/primitives.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "modules/core/error.h"

namespace palpate::geometry {
namespace {

constexpr double kPi = std::numbers::pi;

TriangleSurface unit_icosahedron() {
  const double g = std::numbers::phi;
  TriangleSurface surface;
  surface.nodes = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3& node : surface.nodes) node.normalize();
  surface.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                       {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                       {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                       {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return surface;
}

/// Each triangle into four, the new nodes on the unit sphere.
void subdivide_on_unit_sphere(TriangleSurface& surface) {
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> middles;
  const auto middle_of = [&](std::uint32_t a, std::uint32_t b) {
    const auto next = static_cast<std::uint32_t>(surface.nodes.size());
    const auto [place, is_new] = middles.try_emplace({std::min(a, b), std::max(a, b)}, next);
    if (is_new) surface.nodes.push_back((surface.nodes[a] + surface.nodes[b]).normalized());
    return place->second;
  };
  std::vector<Triangle> finer;
  finer.reserve(4 * surface.triangles.size());
  for (const auto& [a, b, c] : surface.triangles) {
    const std::uint32_t ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  surface.triangles = std::move(finer);
}

struct Ring {
  double radius, z;
};

/// Circles of a capsule from the lower to the upper pole, without the poles.
std::vector<Ring> capsule_rings(double radius, double length, int segments) {
  const int cap_rings = std::max(2, segments / 4);
  const double spacing = 2 * kPi * radius / segments;
  const int spans = length > 0 ? std::max(1, static_cast<int>(std::lround(length / spacing))) : 0;
  std::vector<Ring> rings;
  for (int i = 1; i <= cap_rings; ++i) {
    const double latitude = 0.5 * kPi * (static_cast<double>(i) / cap_rings - 1);
    rings.push_back({radius * std::cos(latitude), radius * std::sin(latitude) - length / 2});
  }
  for (int i = 1; i < spans; ++i) rings.push_back({radius, length * (double(i) / spans - 0.5)});
  const int mirrored = spans > 0 ? cap_rings : cap_rings - 1;  // one equator if the caps touch
  for (int i = mirrored; i >= 1; --i) rings.push_back({rings[i - 1].radius, -rings[i - 1].z});
  return rings;
}

}  // namespace

TriangleSurface make_ball(double radius, int levels) {
  PALPATE_DEMAND(radius > 0 && levels >= 0 && levels <= 7);
  TriangleSurface surface = unit_icosahedron();
  for (int level = 0; level < levels; ++level) subdivide_on_unit_sphere(surface);
  for (Vec3& node : surface.nodes) node *= radius;
  return surface;
}

TriangleSurface make_box(const Vec3& size, int divisions) {
  PALPATE_DEMAND(size.minCoeff() > 0 && divisions >= 1);
  TriangleSurface surface;
  std::map<std::array<int, 3>, std::uint32_t> node_at;
  const auto node_of = [&](const std::array<int, 3>& place) {
    const auto next = static_cast<std::uint32_t>(surface.nodes.size());
    const auto [entry, is_new] = node_at.try_emplace(place, next);
    if (is_new) {
      const Vec3 fraction = Vec3(place[0], place[1], place[2]) / divisions;
      surface.nodes.push_back(size.cwiseProduct(fraction - Vec3::Constant(0.5)));
    }
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool far_side : {false, true}) {
      for (int cell = 0; cell < divisions * divisions; ++cell) {
        std::array<int, 3> corner{};
        corner[axis] = far_side ? divisions : 0;
        const auto at = [&](int du, int dv) {
          corner[u] = cell % divisions + du;
          corner[v] = cell / divisions + dv;
          return node_of(corner);
        };
        const std::uint32_t a = at(0, 0), b = at(1, 0), c = at(1, 1), d = at(0, 1);
        if (far_side) {
          surface.triangles.insert(surface.triangles.end(), {{a, b, c}, {a, c, d}});
        } else {
          surface.triangles.insert(surface.triangles.end(), {{a, c, b}, {a, d, c}});
        }
      }
    }
  }
  return surface;
}

TriangleSurface make_capsule(double radius, double length, int segments) {
  PALPATE_DEMAND(radius > 0 && length >= 0 && segments >= 4);
  const std::vector<Ring> rings = capsule_rings(radius, length, segments);
  TriangleSurface surface;
  surface.nodes.push_back({0, 0, -radius - length / 2});
  for (const Ring& ring : rings) {
    for (int i = 0; i < segments; ++i) {
      const double angle = 2 * kPi * i / segments;
      surface.nodes.push_back(
          {ring.radius * std::cos(angle), ring.radius * std::sin(angle), ring.z});
    }
  }
  surface.nodes.push_back({0, 0, radius + length / 2});
  const auto last = static_cast<std::uint32_t>(surface.nodes.size() - 1);
  const auto ring_count = static_cast<std::uint32_t>(rings.size());
  const auto per_ring = static_cast<std::uint32_t>(segments);
  for (std::uint32_t i = 0; i < per_ring; ++i) {
    const std::uint32_t next = (i + 1) % per_ring, top = 1 + (ring_count - 1) * per_ring;
    surface.triangles.push_back({0, 1 + next, 1 + i});
    surface.triangles.push_back({last, top + i, top + next});
    for (std::uint32_t r = 0; r + 1 < ring_count; ++r) {
      const std::uint32_t low = 1 + r * per_ring, high = low + per_ring;
      surface.triangles.push_back({low + i, low + next, high + next});
      surface.triangles.push_back({low + i, high + next, high + i});
    }
  }
  return surface;
}

TriangleSurface make_cone(double radius, double length, int sides) {
  PALPATE_DEMAND(radius > 0 && length > 0 && sides >= 3);
  TriangleSurface surface;
  surface.nodes = {{0, 0, 0}, {0, 0, length}};
  const auto rim = static_cast<std::uint32_t>(sides);
  for (std::uint32_t i = 0; i < rim; ++i) {
    const double angle = 2 * kPi * i / sides;
    surface.nodes.push_back({radius * std::cos(angle), radius * std::sin(angle), length});
    const std::uint32_t next = (i + 1) % rim;
    surface.triangles.push_back({0, 2 + next, 2 + i});
    surface.triangles.push_back({1, 2 + i, 2 + next});
  }
  return surface;
}

TriangleSurface make_jaws(double length, double width, double thickness, double opening) {
  PALPATE_DEMAND(length > 0 && width > 0 && thickness > 0 && opening > 0 && opening < kPi / 2);
  // Seen along x, each jaw is a quadrangle: inner hinge, inner tip, outer tip, outer hinge, which
  // goes on beyond the inner one by the thickness. A triangle between the two joins them.
  const double c = std::cos(opening / 2), s = std::sin(opening / 2);
  const Vec3 hinge(0, 0, length * c);
  TriangleSurface surface;
  for (const double x : {width / 2, -width / 2}) {
    surface.nodes.push_back(hinge + Vec3(x, 0, 0));
    for (const double side : {1.0, -1.0}) {
      const Vec3 down(0, side * s, -c), out(0, side * c, s), to_face(x, 0, 0);
      surface.nodes.push_back(hinge + to_face + length * down);
      surface.nodes.push_back(hinge + to_face + length * down + thickness * out);
      surface.nodes.push_back(hinge + to_face - thickness * down + thickness * out);
    }
  }
  // Seen from +x, y to the right, z up: faces counterclockwise, the outline clockwise.
  constexpr std::array<std::uint32_t, 7> kOutline{0, 4, 5, 6, 3, 2, 1};
  constexpr std::array<Triangle, 5> kFace{{{0, 1, 2}, {0, 2, 3}, {0, 3, 6}, {0, 6, 5}, {0, 5, 4}}};
  const auto count = static_cast<std::uint32_t>(kOutline.size());
  for (const auto& [a, b, d] : kFace) {
    surface.triangles.push_back({a, b, d});
    surface.triangles.push_back({count + a, count + d, count + b});
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t from = kOutline[i], to = kOutline[(i + 1) % count];
    surface.triangles.push_back({from, to, count + to});
    surface.triangles.push_back({from, count + to, count + from});
  }
  return surface;
}

TriangleSurface make_tetrahedron(double edge) {
  PALPATE_DEMAND(edge > 0);
  const double s = edge / (2 * std::numbers::sqrt2);  // the cube's corners have edge 2√2
  return {{{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}},
          {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
}

}  // namespace palpate::geometry
