#include "deformation/springs/patch_product.h"

#include <catch2/catch.hpp>
#include <random>

#include "deformation/springs/patch_springs.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

/// A ball of 642 nodes blown up unevenly, and some nodes of it, not in order.
struct Patched {
  OrganModel model = testing::ball_model(3);
  std::vector<Vec3> positions = model.rest_positions;
  Patch patch;
  std::vector<std::uint32_t> slices;
  SpringHessianProduct springs{model, model.network(), true};

  Patched() {
    for (Vec3& x : positions) x *= 1.05 + 0.02 * x.x() / testing::kBallRadius;
    const std::vector<std::uint32_t> touched{300, 77};
    grow_patch(model, Neighbours(model, {}), positions, touched, positions[300], 60, patch);
    springs.find_slices(patch.nodes, slices);
  }

  std::vector<Vec4f> direction() const {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> any(-1, 1);
    std::vector<Vec4f> p(patch.nodes.size());
    for (Vec4f& v : p) v = {any(random), any(random), any(random), 0};
    return p;
  }
};

TEST_CASE("patch product: to the bit the springs' own product where all other nodes are held") {
  // Oracle: the product over all nodes, whose vector is zero but in the patch.
  Patched at;
  at.springs.linearise(at.positions, 0.01);
  const auto p = at.direction();
  std::vector<Vec4f> all(at.model.node_count());
  for (auto& node : at.springs.nodes()) node.vector.setZero();
  for (std::size_t i = 0; i < p.size(); ++i) {
    at.springs.nodes()[at.patch.nodes[i]].vector = p[i];
  }
  at.springs.apply(all);
  for (auto& node : at.springs.nodes()) node.vector = Vec4f(1, 2, 3, 0);  // of somebody before

  PatchProduct product(at.springs);
  product.take(at.patch, at.slices);
  REQUIRE(product.nodes().size() == p.size() + 1);
  for (std::size_t i = 0; i < p.size(); ++i) product.nodes()[i].vector = p[i];
  std::vector<Vec4f> found(p.size());
  const double curvature = product.apply(found);
  for (std::size_t i = 0; i < p.size(); ++i) CHECK(found[i] == all[at.patch.nodes[i]]);
  CHECK(curvature == Approx(dot(p, found)).epsilon(1e-5));  // float
}

TEST_CASE("patch product: of any shares of mass, damping and stiffness") {
  // Oracle: the plain matrix of the patch. Tolerance: couplings of eight binary digits, of a node's
  // diagonal block.
  Patched at;
  const SpringShares shares{.mass = 2e3, .damping = 30, .stiffness = 0.7};
  at.springs.linearise(at.positions, shares, at.slices);
  const auto size = static_cast<Eigen::Index>(3 * at.patch.nodes.size());
  Eigen::MatrixXf stiffness = Eigen::MatrixXf::Zero(size, size), damping = stiffness;
  PatchSprings(at.model.network(), at.model.node_count())
      .add(at.positions, at.patch, stiffness, damping);
  const Eigen::MatrixXf lower = static_cast<float>(shares.stiffness) * stiffness +
                                static_cast<float>(shares.damping) * damping;
  Eigen::MatrixXd A = lower.selfadjointView<Eigen::Lower>().toDenseMatrix().cast<double>();
  const auto p = at.direction();
  Eigen::VectorXd x(size);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto first = static_cast<Eigen::Index>(3 * i);
    A.diagonal().segment<3>(first).array() += shares.mass * at.model.masses[at.patch.nodes[i]];
    x.segment<3>(first) = p[i].head<3>().cast<double>();
  }
  const Eigen::VectorXd expected = A * x;
  PatchProduct product(at.springs);
  product.take(at.patch, at.slices);
  for (std::size_t i = 0; i < p.size(); ++i) product.nodes()[i].vector = p[i];
  std::vector<Vec4f> found(p.size());
  product.apply(found);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto first = static_cast<Eigen::Index>(3 * i);
    const Mat3 own = A.block<3, 3>(first, first);
    CHECK((found[i].head<3>().cast<double>() - expected.segment<3>(first)).norm() <
          4e-3 * own.norm());
    CHECK((at.springs.diagonal()[at.patch.nodes[i]] - own).norm() < 2e-3 * own.norm());
  }
}

}  // namespace
}  // namespace palpate::deformation
