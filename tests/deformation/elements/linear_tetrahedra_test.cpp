#include "deformation/elements/linear_tetrahedra.h"

#include "tests/deformation/steppers/tetrahedral_solids.h"

using namespace palpate;
using namespace palpate::deformation;
using namespace palpate::deformation::testing;

TEST_CASE("linear tetrahedra: an affine map has its matrix as deformation gradient everywhere") {
  // Oracle: analytic. Coordinates of 1 m, edges of 1.5 cm: rounding 1e-16 / 0.015.
  const auto model = cube_model(solid_organ("corotational", 0.3));
  const LinearTetrahedra tetrahedra(model.rest_positions, model.mesh().tetrahedra);
  Mat3 A;
  A << 1.2, 0.3, -0.1, 0, 0.7, 0.2, 0.4, -0.5, -0.9;
  std::vector<Vec3> positions;
  for (const Vec3& X : model.rest_positions) positions.emplace_back(A * X + Vec3(1, 2, 3));
  double volume = 0;
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    CHECK((tetrahedra.deformation_gradient(e, positions) - A).norm() < 1e-12);
    CHECK(tetrahedra.gradients[e].rowwise().sum().norm() < 1e-10);
    volume += tetrahedra.volumes[e];
  }
  CHECK(volume == Approx(0.06 * 0.06 * 0.06).epsilon(1e-12));
}
