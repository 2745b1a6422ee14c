// The shapes a probe may have. All that is known of one is here and in its keys (schema.h): its
// struct, its place among ProbeShape, the form it comes down to (probe_shape.cpp), how it is drawn
// at random.
#pragma once

#include <variant>

#include "modules/geometry/probe_form.h"
#include "modules/scene/mesh.h"

namespace palpate::scene {

struct SphereShape {
  double radius = 0.006;  ///< `radius_m` [1e-4 … 0.5]
};
struct CapsuleShape {
  double radius = 0.005;  ///< `radius_m` [1e-4 … 0.5]
  double length = 0.05;   ///< `length_m`, between the end centres, along z [1e-4 … 2]
};
struct BoxShape {
  Vec3 size = Vec3::Constant(0.02);  ///< `size_m`, about the origin [1e-4 … 2 each]
};
struct ConeShape {
  double radius = 0.002;  ///< `radius_m`, of the base [1e-4 … 0.5]
  double length = 0.02;   ///< `length_m`, from the point at the origin along +z [1e-4 … 2]
};
/// Two jaws that stand open.
struct GrasperShape {
  double length = 0.02;      ///< `length_m`, of a jaw [1e-4 … 2]
  double width = 0.005;      ///< `width_m`, along x [1e-4 … 2]
  double thickness = 0.002;  ///< `thickness_m`, of a jaw [1e-4 … 0.5]
  double opening = 0.5;      ///< `opening_rad`, between the jaws' inner faces [0.02 … 1.5]
};
struct PlaneShape {};  ///< solid half-space z ≤ 0
struct MeshShape {
  Mesh mesh;  ///< closed surface in the probe's frame; the keys of Mesh
};
using ProbeShape = std::variant<SphereShape, CapsuleShape, BoxShape, ConeShape, GrasperShape,
                                PlaneShape, MeshShape>;
///< keys `sphere`, `capsule`, `box`, `cone`, `grasper`, `plane`, `mesh`

/// What the shape is, in the probe's frame P [m].
/// @param mesh  the surface of a MeshShape, see load_probe_mesh(); else not used
geometry::ProbeForm form_of(const ProbeShape& shape, geometry::TriangleSurface mesh = {});

/// The mesh that the shape names, if it does.
Mesh* mesh_of(ProbeShape& shape);
const Mesh* mesh_of(const ProbeShape& shape);

/// A shape for an organ of about `size` [m], from needles and plates to what is larger than it.
/// @tparam Random  offers below(count), uniform(low, high), log_uniform(low, high)
template <class Random>
ProbeShape random_shape(Random& random, double size) {
  switch (random.below(10)) {
    case 0:
    case 1:
      return SphereShape{size * random.log_uniform(0.01, 0.8)};
    case 2:
      return CapsuleShape{1e-4, size * random.uniform(0.5, 2)};  // a needle
    case 3:
      return CapsuleShape{size * random.log_uniform(0.01, 0.3), size * random.uniform(0.1, 2)};
    case 4:
      return BoxShape{Vec3(2 * size, 2 * size, 0.02 * size + 1e-4)};  // a plate
    case 5:
      return BoxShape{Vec3::Constant(size * random.log_uniform(0.02, 1))};
    case 6:
      return PlaneShape{};
    case 7: {
      const double length = size * random.uniform(0.1, 2);
      return ConeShape{1e-4 + length * random.uniform(0.02, 0.5), length};
    }
    case 8: {
      const double length = size * random.uniform(0.1, 1);
      return GrasperShape{length, 0.2 * length, 0.1 * length, random.uniform(0.05, 1.2)};
    }
    default:
      return MeshShape{};
  }
}

}  // namespace palpate::scene
