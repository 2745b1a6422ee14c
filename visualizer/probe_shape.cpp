#include "visualizer/probe_shape.h"

#include <algorithm>

#include "modules/geometry/primitives.h"

namespace palpate::visualizer {
namespace {

geometry::TriangleSurface square_patch(double size) {
  const double h = 0.5 * size;
  return {{{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace

geometry::TriangleSurface probe_surface(const scene::ProbeShape& shape, double patch_size,
                                        const geometry::TriangleSurface& mesh) {
  struct Visitor {
    double patch_size;
    const geometry::TriangleSurface& mesh;
    geometry::TriangleSurface operator()(const scene::SphereShape& sphere) const {
      return geometry::make_ball(sphere.radius, 3);
    }
    geometry::TriangleSurface operator()(const scene::CapsuleShape& capsule) const {
      return geometry::make_capsule(capsule.radius, capsule.length, 32);
    }
    geometry::TriangleSurface operator()(const scene::BoxShape& box) const {
      return geometry::make_box(box.size);
    }
    geometry::TriangleSurface operator()(const scene::PlaneShape&) const {
      return square_patch(patch_size);
    }
    geometry::TriangleSurface operator()(const scene::MeshShape&) const { return mesh; }
  };
  return std::visit(Visitor{patch_size, mesh}, shape);
}

double reach(const geometry::TriangleSurface& surface) {
  double largest = 0;
  for (const Vec3& node : surface.nodes) largest = std::max(largest, node.norm());
  return largest;
}

}  // namespace palpate::visualizer
