// Displacements at any point of an organ, from those of its nodes.
#pragma once

#include <utility>
#include <vector>

#include "modules/geometry/organ_shape.h"

namespace palpate::chart {

/// What a point's displacement is made of: Σ weight · displacement of node, Σ weight = 1.
using NodeWeights = std::vector<std::pair<std::uint32_t, double>>;

/// On the surface within `tolerance` [m]: barycentric in its nearest triangle. Inside a solid: the
/// shape functions of its tetrahedron. Inside a surface, which knows nothing of its inside: mean
/// value coordinates.
///   T. Ju, S. Schaefer, J. Warren, "Mean value coordinates for closed triangular meshes", ACM TOG
///   24(3), 2005.
/// @param point  at rest [m]
NodeWeights weights_at(const geometry::OrganShape& shape, const Vec3& point,
                       double tolerance = 1e-6);

}  // namespace palpate::chart
