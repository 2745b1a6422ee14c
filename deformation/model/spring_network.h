// The springs of a surface organ: structural, bending and inner, with virtual nodes on the
// dominant axis.
//
// After M. Hong, S. Jung, M.-H. Choi, S. W. J. Welch, "Modeling Volume-Preserved Human Organs for
// Surgical Simulation".
//
//   structural  on the mesh edges
//   bending     between nodes two edges apart (secondary neighbours): hold the rest curvature
//   inner       from each surface node to its nearest virtual node: pass a push to the far side
//
// Stiffness. A triangle of an isotropic membrane (plane stress, ν = ⅓, wall t) is matched by edge
// springs k = (√3/4) E t per adjacent triangle, exactly if equilateral. On a regular mesh of edge L
// the membrane stiffness is ∝ Σ k L² over the springs of a node: 3 structural of L² against
// 3·(2L)² + 3·(√3 L)² = 21 L² of bending. With k_bending = r k_structural, dividing both by
// 1 + 7 r keeps the membrane's E t whatever r.
//
// Tissue is not that membrane: its ν is ½, and it softens as it is stretched thin. Against an
// incompressible neo-Hookean wall the springs are too soft under small stretch in both directions
// (4/3), too stiff under large stretch (0.84 at 20 % along one direction). One number stands for
// the mean of what a squeezed organ does: every E t here is kMembraneFactor times that of the
// scene, fitted to a hollow ball of finite elements (docs/calibration.md).
//
// Inner springs are a foundation under the membrane. Its natural unit is E t / R² per area (R =
// mean inner spring length), so k_i = inner_ratio · E t / R² · (area of node i): independent of
// mesh size.
#pragma once

#include <vector>

#include "modules/core/organ_limits.h"
#include "modules/geometry/triangle_surface.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

/// E t of the springs over that of the tissue; `palpate calibrate` fits it.
inline constexpr double kMembraneFactor = 0.93;

struct Spring {
  std::uint32_t node_a = 0, node_b = 0;
  double rest_length = 0;  ///< [m]
  double stiffness = 0;    ///< [N/m]
};

struct SpringNetwork {
  std::vector<Vec3> virtual_nodes;  ///< at rest [m]; numbered after the surface nodes
  std::vector<double> node_areas;   ///< a third of the adjacent triangles' areas [m²], surface
  std::vector<Spring> springs;      ///< by family: structural, bending, inner
  std::vector<double> damping;      ///< axial, per spring [N·s/m]; by build_spring_organ()
  std::size_t structural_count = 0, bending_count = 0, inner_count = 0;

  SpringFamily family(std::size_t spring) const;
};

/// Virtual nodes at the centres of `count` equal sections of the surface's extent along its
/// dominant axis, each at the centroid of the surface nodes of its section [m]. Sections with fewer
/// than three get none; where none is left, the centroid of all nodes.
std::vector<Vec3> place_virtual_nodes(const geometry::TriangleSurface& surface, std::size_t count);

/// Every stiffness is proportional to kMembraneFactor · E t.
/// @param surface  closed, at rest [m], of at most kMaxNodes and kMaxTriangles
/// @throws InputError for more than kMaxSprings springs, before there are any of them
SpringNetwork build_spring_network(const geometry::TriangleSurface& surface,
                                   const scene::Tissue& tissue, const scene::Springs& springs);

}  // namespace palpate::deformation
