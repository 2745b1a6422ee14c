// The tetrahedra of a solid organ, and the tissue they are made of.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "deformation/materials/elastic_constants.h"
#include "modules/core/types.h"
#include "modules/geometry/tet_mesh.h"

namespace palpate::deformation {

struct TetMesh {
  std::vector<geometry::Tetrahedron> tetrahedra;
  std::vector<std::array<std::uint32_t, 6>> edge_nodes;  ///< as in geometry::OrganShape
  double youngs_modulus = 0;                             ///< [Pa]
  double poisson_ratio = 0;
  double density = 0;  ///< [kg/m³]

  ElasticConstants elastic() const { return {youngs_modulus, poisson_ratio}; }
};

/// How many tetrahedra enclose no positive volume at these positions [m].
std::size_t inverted_tetrahedra(const TetMesh& mesh, const std::vector<Vec3>& positions);

}  // namespace palpate::deformation
