#include "deformation/elements/corotational.h"

#include "tests/deformation/elements/element_checks.h"

using namespace palpate;
using namespace palpate::deformation;
using namespace palpate::deformation::testing;

TEST_CASE("corotational: forces are minus the energy's gradient") {
  // Oracle: finite differences, over 1e-6 of cells of 15 mm; nodes are off by up to 3 mm. The
  // turning of R leaves P = ∂ψ/∂F, so the forces are exact.
  const auto model = cube_model(solid_organ("corotational", 0.4), Vec3::Zero(), 2);
  auto elements = elements_of<Corotational>(model);
  CHECK(force_error(elements, shaken(model, 3e-3), 1e-7) < 1e-5);
}

TEST_CASE("corotational: the matrix is the forces' derivative at rest, turned or not") {
  // Oracle: finite differences; without strain the turning of R makes no difference. Floats.
  const auto model = cube_model(solid_organ("corotational", 0.4), Vec3::Zero(), 2);
  auto elements = elements_of<Corotational>(model);
  auto positions = model.rest_positions;
  CHECK(matrix_error(elements, model, positions, 0.01, 1e-7) < 1e-5);
  const Quat turn(Eigen::AngleAxisd(2, Vec3(1, 2, -1).normalized()));
  for (Vec3& x : positions) x = turn * x;
  CHECK(matrix_error(elements, model, positions, 0.01, 1e-7) < 1e-5);
  CHECK(elements.energy(positions) < 1e-20);
}

TEST_CASE("corotational: a block in uniaxial stretch has the force of linear elasticity") {
  // Oracle: analytic, F = E A ε for sides contracted by ν ε, exact for stretches without turning.
  const double strain = 0.1;
  const auto model = cube_model(solid_organ("corotational", 0.3));
  auto elements = elements_of<Corotational>(model);
  auto positions = model.rest_positions;
  for (Vec3& x : positions) {
    x = x.cwiseProduct(Vec3(1 - 0.3 * strain, 1 - 0.3 * strain, 1 + strain));
  }
  linearise(elements, model, positions, 0.01);
  double pull = 0, across = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (model.rest_positions[i].z() > 0.0599) pull -= elements.forces()[i].z();
    across = std::max(across, std::abs(elements.forces()[i].x()));
  }
  CHECK(pull == Approx(5e3 * 0.06 * 0.06 * strain).epsilon(1e-9));
  CHECK(across < 1e-9);
}
