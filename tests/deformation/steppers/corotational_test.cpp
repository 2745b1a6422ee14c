#include "deformation/steppers/corotational.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include "tests/deformation/steppers/tissue_checks.h"

using namespace palpate;
using namespace palpate::deformation;
using namespace palpate::deformation::testing;

namespace {

/// By singular values, the least one turned round where det F < 0.
Mat3 nearest_rotation_by_svd(const Mat3& F) {
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 sign = Mat3::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * sign * svd.matrixV().transpose();
}

}  // namespace

TEST_CASE("nearest rotation: agrees with singular values, inside out or not") {
  // Oracle: independent method. Random matrices are ill conditioned at times: 1e-8.
  std::srand(5);
  for (int k = 0; k < 500; ++k) {
    const Mat3 F = Mat3::Random();
    CHECK((nearest_rotation(F) - nearest_rotation_by_svd(F)).norm() < 1e-8);
  }
  CHECK(nearest_rotation(Mat3::Identity()) == Mat3::Identity());
  CHECK(nearest_rotation(Mat3::Zero()) == Mat3::Identity());
  const Mat3 half_turn = Vec3(1, -1, -1).asDiagonal();
  CHECK((nearest_rotation(half_turn) - half_turn).norm() < 1e-12);
  CHECK(nearest_rotation(-Mat3::Identity()).allFinite());
}

TEST_CASE("corotational: forces are minus the energy's gradient") {
  // Oracle: finite differences, over 1e-6 of cells of 15 mm; nodes are off by up to 3 mm. The
  // turning of R leaves P = ∂ψ/∂F, so the forces are exact.
  const auto model = cube_model(solid_organ(scene::Model::kCorotational, 0.4), Vec3::Zero(), 2);
  Corotational tissue(model);
  CHECK(force_error(tissue, shaken(model, 3e-3), 1e-7) < 1e-5);
}

TEST_CASE("corotational: the matrix is the forces' derivative at rest, turned or not") {
  // Oracle: finite differences; without strain the turning of R makes no difference. Floats.
  const auto model = cube_model(solid_organ(scene::Model::kCorotational, 0.4), Vec3::Zero(), 2);
  Corotational tissue(model);
  auto positions = model.rest_positions;
  CHECK(matrix_error(tissue, model, positions, 0.01, 1e-7) < 1e-5);
  const Quat turn(Eigen::AngleAxisd(2, Vec3(1, 2, -1).normalized()));
  for (Vec3& x : positions) x = turn * x;
  CHECK(matrix_error(tissue, model, positions, 0.01, 1e-7) < 1e-5);
  CHECK(tissue.energy(positions) < 1e-20);
}

TEST_CASE("corotational: a block in uniaxial stretch has the force of linear elasticity") {
  // Oracle: analytic, F = E A ε for sides contracted by ν ε, exact for stretches without turning.
  const double strain = 0.1;
  const auto model = cube_model(solid_organ(scene::Model::kCorotational, 0.3));
  Corotational tissue(model);
  auto positions = model.rest_positions;
  for (Vec3& x : positions) {
    x = x.cwiseProduct(Vec3(1 - 0.3 * strain, 1 - 0.3 * strain, 1 + strain));
  }
  tissue.linearise(positions, 0.01);
  double pull = 0, across = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (model.rest_positions[i].z() > 0.0599) pull -= tissue.forces()[i].z();
    across = std::max(across, std::abs(tissue.forces()[i].x()));
  }
  CHECK(pull == Approx(5e3 * 0.06 * 0.06 * strain).epsilon(1e-9));
  CHECK(across < 1e-9);
}
