#include "studies/fuzz/shape_store.h"

#include <array>

#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/primitives.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/models.h"

namespace palpate::fuzz {
namespace {

constexpr std::array<const char*, kShapeCount> kNames{
    "tetrahedron", "ball_42", "box", "capsule", "stomach", "liver", "ball_162", "liver_300"};
constexpr double kInnerSize = 0.4;  // few nodes inside

/// Centred, its longest side 1 m.
geometry::TriangleSurface of_unit_size(geometry::TriangleSurface surface) {
  Vec3 low = surface.nodes[0], high = low;
  for (const Vec3& p : surface.nodes) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (Vec3& p : surface.nodes) p = (p - (low + high) / 2) / (high - low).maxCoeff();
  return surface;
}

geometry::TriangleSurface make(Shape shape, const std::filesystem::path& scenes) {
  switch (shape) {
    case Shape::kTetrahedron:
      return geometry::make_tetrahedron(1);
    case Shape::kBall42:
      return geometry::make_ball(0.5, 1);
    case Shape::kBox:
      return geometry::make_box({1, 0.8, 0.6}, 3);
    case Shape::kCapsule:
      return geometry::make_capsule(0.2, 0.6, 10);
    case Shape::kStomach:
      return geometry::load_organ_surface(scenes / "meshes/stomach.ply", "m", 90);
    case Shape::kLiver:
      return geometry::load_organ_surface(scenes / "meshes/liver.ply", "m", 120);
    case Shape::kBall162:
      return geometry::make_ball(0.5, 2);
    case Shape::kLiver300:
      break;
  }
  return geometry::load_organ_surface(scenes / "meshes/liver.ply", "m", 300);
}

Vec3 stretched(const Vec3& p, const Vec3& size) {
  return p.cwiseProduct(size).cast<float>().cast<double>();
}

}  // namespace

const char* name_of(Shape shape) { return kNames[static_cast<std::size_t>(shape)]; }

ShapeStore::ShapeStore(const std::filesystem::path& scenes) {
  for (std::size_t i = 0; i < kShapeCount; ++i) {
    Entry entry{of_unit_size(make(static_cast<Shape>(i), scenes)), {}};
    entry.solid = geometry::shape_of(geometry::fill_surface(entry.surface, kInnerSize));
    entries_.push_back(std::move(entry));
  }
}

const geometry::TriangleSurface& ShapeStore::surface(Shape shape) const {
  return entries_[static_cast<std::size_t>(shape)].surface;
}

geometry::OrganShape ShapeStore::shape(const PlacedShape& placed, const std::string& model) const {
  const Entry& entry = entries_[static_cast<std::size_t>(placed.shape)];
  geometry::OrganShape shape =
      scene::is_solid(model) ? entry.solid : geometry::OrganShape(entry.surface);
  for (auto* nodes : {&shape.surface.nodes, &shape.inner_nodes}) {
    for (Vec3& node : *nodes) node = stretched(node, placed.size);
  }
  return scene::is_quadratic(model) ? geometry::with_edge_nodes(shape) : shape;
}

}  // namespace palpate::fuzz
