// The shapes random scenes are made of: few, meshed once per run, stretched for each scene.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "modules/geometry/organ_shape.h"
#include "modules/scene/scene.h"

namespace palpate::fuzz {

/// Smaller meshes first, so that a scene is made simpler by a lower index.
enum class Shape { kTetrahedron, kBall42, kBox, kCapsule, kStomach, kLiver, kBall162, kLiver300 };
inline constexpr std::size_t kShapeCount = 8;
/// The largest shape that implicit models of solids get: they factorise matrices.
inline constexpr std::size_t kTinyShapeCount = 3;
const char* name_of(Shape shape);

/// A shape of unit size (its longest side), stretched.
struct PlacedShape {
  Shape shape = Shape::kBall42;
  Vec3 size = Vec3::Constant(0.1);  ///< of each axis [m]
};

class ShapeStore {
 public:
  /// @param scenes  folder of the shipped meshes
  /// @throws InputError if a mesh cannot be read, or gmsh is not there to fill it
  explicit ShapeStore(const std::filesystem::path& scenes);

  /// In the mesh's own frame [m]; as float32 files hold it.
  geometry::OrganShape shape(const PlacedShape& placed, const std::string& model) const;
  const geometry::TriangleSurface& surface(Shape shape) const;

 private:
  struct Entry {
    geometry::TriangleSurface surface;
    geometry::OrganShape solid;
  };
  std::vector<Entry> entries_;
};

}  // namespace palpate::fuzz
