#include "studies/chart/displacement_field.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::chart {
namespace {

Vec3 interpolate(const geometry::OrganShape& shape, const Vec3& point, Vec3 (*field)(const Vec3&)) {
  Vec3 sum = Vec3::Zero();
  for (const auto& [node, weight] : weights_at(shape, point)) {
    sum += weight * field(shape.node(node));
  }
  return sum;
}

Vec3 affine(const Vec3& p) { return Vec3(1 + p.x() - 2 * p.y(), 3 * p.z(), 0.5 - p.x() + p.y()); }
Vec3 quadratic(const Vec3& p) { return Vec3(p.x() * p.x(), p.y() * p.z(), p.z() * p.z() - p.x()); }

const std::vector<Vec3> kInside{{0.03, 0.05, 0.1}, {0.071, 0.153, 0.22}, {0.05, 0.1, 0.15}};

TEST_CASE("displacement field: affine fields come out exactly, on, in and inside of surfaces") {
  // Oracle: affine precision of barycentric, linear and mean value coordinates.
  const auto solid = geometry::shape_of(geometry::testing::block({0.1, 0.2, 0.3}, 2, 3, 4));
  const geometry::OrganShape surface(solid.surface);
  for (const auto& shape : {solid, surface, geometry::with_edge_nodes(solid)}) {
    for (const Vec3& point : kInside) {
      CHECK((interpolate(shape, point, affine) - affine(point)).norm() < 1e-9);
    }
    const Vec3 on_face(0.1, 0.07, 0.11);
    CHECK((interpolate(shape, on_face, affine) - affine(on_face)).norm() < 1e-9);
  }
}

TEST_CASE("displacement field: quadratic elements carry quadratic fields exactly") {
  // Oracle: the field.
  const auto shape = geometry::with_edge_nodes(
      geometry::shape_of(geometry::testing::block({0.1, 0.2, 0.3}, 2, 2, 2)));
  for (const Vec3& point : kInside) {
    CHECK((interpolate(shape, point, quadratic) - quadratic(point)).norm() < 1e-12);
  }
}

}  // namespace
}  // namespace palpate::chart
