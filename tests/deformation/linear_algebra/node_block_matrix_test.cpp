#include "deformation/linear_algebra/node_block_matrix.h"

#include "tests/deformation/steppers/tetrahedral_solids.h"

using namespace palpate;
using namespace palpate::deformation;
using namespace palpate::deformation::testing;

TEST_CASE("node block matrix: agrees with a dense one") {
  // Oracle: brute force, a dense matrix of doubles; float has 6e-8 of relative rounding per term.
  const auto mesh = geometry::testing::block(Vec3(1, 1, 1), 2, 1, 1);
  const auto nodes = static_cast<Eigen::Index>(mesh.nodes.size());
  const NodePairs pairs(mesh.nodes.size(), mesh.tetrahedra);
  NodeBlockMatrix matrix(pairs);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * nodes, 3 * nodes);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-1, 1);
  matrix.set_zero();
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < 4; ++b) {
        const auto i = mesh.tetrahedra[e][a], j = mesh.tetrahedra[e][b];
        if (i > j) continue;
        const Vec4f u(any(random), any(random), any(random), 0);
        const Vec4f v = i == j ? u : Vec4f(any(random), any(random), any(random), 0);
        matrix.add(pairs.of_elements[e][4 * a + b], outer(u, v));
        const Mat3 block = (u.head<3>() * v.head<3>().transpose()).cast<double>();
        dense.block<3, 3>(3 * i, 3 * j) += block;
        if (i != j) dense.block<3, 3>(3 * j, 3 * i) += block.transpose();
      }
    }
  }
  matrix.mirror();
  std::vector<Vec4f> p(mesh.nodes.size()), out(mesh.nodes.size());
  Eigen::VectorXd x(3 * nodes);
  for (std::size_t i = 0; i < p.size(); ++i) {
    p[i] = Vec4f(any(random), any(random), any(random), 0);
    x.segment<3>(3 * static_cast<Eigen::Index>(i)) = p[i].head<3>().cast<double>();
  }
  matrix.apply(p, out);
  const Eigen::VectorXd expected = dense * x;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto at = 3 * static_cast<Eigen::Index>(i);
    CHECK((out[i].head<3>().cast<double>() - expected.segment<3>(at)).norm() < 3e-5);
    CHECK((matrix.diagonal(i) - dense.block<3, 3>(at, at)).norm() < 1e-5);
    CHECK(out[i][3] == 0);
  }
}
