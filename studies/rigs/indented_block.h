// A block of 8 × 8 × 8 cm on its held base z = 0, and a sphere of 5 mm that presses the middle of
// its top.
#pragma once

#include "modules/geometry/tet_mesh.h"
#include "modules/scene/scene.h"

namespace palpate::rigs {

inline constexpr double kBlockHalfWidth = 0.04, kBlockHeight = 0.08;  ///< [m]
inline constexpr double kIndenterRadius = 5e-3;                       ///< [m]

/// Edge lengths for Gmsh: `finest` + `growth` (r²/(r² + `flat`²))², r from the middle of the top.
struct BlockSizes {
  double finest = 0;  ///< [m]
  double growth = 0;  ///< [m]
  double flat = 0;    ///< how far from the sphere edges stay about as fine [m]
};
std::string text_of(const BlockSizes& sizes);

/// @throws InputError if Gmsh is missing
geometry::TetMesh whole_block(const BlockSizes& sizes);
/// The quarter x, y ≥ 0, meshed finer than `size` of the sphere's radius to 1.2 radii from it.
/// @throws InputError if Gmsh is missing
geometry::TetMesh quarter_block(double size);
/// Whether a node of the quarter at `p` is held along `axis`: by the base or by symmetry.
bool is_constrained_in_quarter(const Vec3& p, int axis);

/// Where an organ is held that is the whole block.
scene::Region block_base();
/// Adds the sphere as a probe, without friction.
void add_indenter(scene::Scene& scene);
/// Where the sphere's middle is `depth` after it touched the block at rest [m].
Vec3 indenter_at(double depth);

}  // namespace palpate::rigs
