// The organs that ship, as formulas. Frame: z up, the patient faces −y, the patient's left is +x:
// looking along +y one sees the usual frontal picture. Only + − × ÷ √ are used, which IEEE 754
// rounds the same everywhere.
#pragma once

#include <array>

#include "modules/geometry/triangle_surface.h"

namespace palpate::meshes {

/// A filled adult stomach: a tube of varying width along a J, with the stubs of oesophagus and
/// duodenum.
double stomach_shape(const Vec3& p);

/// An adult liver: large right lobe, thin left lobe, hollow underside with the gallbladder's bed.
double liver_shape(const Vec3& p);

geometry::TriangleSurface make_ball_mesh();             ///< 642 nodes, radius 50 mm
geometry::TriangleSurface make_stomach_mesh();          ///< 550 nodes
geometry::TriangleSurface make_stomach_refined_mesh();  ///< 19,362 nodes
geometry::TriangleSurface make_liver_mesh();            ///< 544 nodes

struct ShippedMesh {
  const char* file_name;
  geometry::TriangleSurface (*make)();
};
inline constexpr std::array<ShippedMesh, 4> kShippedMeshes{
    {{"ball.ply", make_ball_mesh},
     {"stomach.ply", make_stomach_mesh},
     {"stomach_refined.ply", make_stomach_refined_mesh},
     {"liver.ply", make_liver_mesh}}};

}  // namespace palpate::meshes
