#include "deformation/springs/patch_product.h"

#include <catch2/catch.hpp>
#include <random>

#include "deformation/springs/patch_springs.h"
#include "tests/deformation/organs.h"
#include "tests/deformation/springs/chunk_threads.h"

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
  for (auto& node : at.springs.nodes()) node.vector = Vec4f(1, 2, 3, 0);  // of somebody else

  PatchProduct product(at.springs);
  product.take(at.patch);
  REQUIRE(product.nodes().size() > p.size());
  for (std::size_t i = 0; i < p.size(); ++i) product.nodes()[i].vector = p[i];
  std::vector<Vec4f> found(p.size());
  const double curvature = product.apply(found);
  for (std::size_t i = 0; i < p.size(); ++i) CHECK(found[i] == all[at.patch.nodes[i]]);
  CHECK(curvature == Approx(dot(p, found)).epsilon(1e-5));  // float
}

TEST_CASE("patch product: couplings of contacts within the patch, and partly beyond") {
  // Oracle: the product over all nodes with the same couplings.
  Patched at;
  at.springs.linearise(at.positions, 0.01);
  std::vector<std::uint32_t> beyond;
  for (std::uint32_t node = 0; beyond.size() < 3; ++node) {
    if (at.patch.place(node) < 0) beyond.push_back(node);
  }
  const Vec4f arm(0.3F, -0.2F, 0.1F, 0);
  const std::vector<ContactCoupling> couplings{
      {{at.patch.nodes[3], at.patch.nodes[9], beyond[0]}, {arm, 2 * arm, arm}},
      {{beyond[0], beyond[1], beyond[2]}, {arm, arm, arm}}};
  PatchProduct product(at.springs);
  product.take(at.patch);
  at.springs.couple(couplings);
  product.take_couplings(at.patch);
  const auto p = at.direction();
  std::vector<Vec4f> all(at.model.node_count()), found(p.size());
  for (auto& node : at.springs.nodes()) node.vector.setZero();
  for (std::size_t i = 0; i < p.size(); ++i) {
    at.springs.nodes()[at.patch.nodes[i]].vector = product.nodes()[i].vector = p[i];
  }
  CHECK(product.apply(found) == Approx(at.springs.apply(all)).epsilon(1e-5));  // float
  for (std::size_t i = 0; i < p.size(); ++i) CHECK(found[i] == all[at.patch.nodes[i]]);
}

TEST_CASE("patch product: the bits do not depend on threads, and a patch of no nodes has none") {
  // Oracle: the calling thread alone. A patch of more slices than a part has.
  Patched at;
  at.springs.linearise(at.positions, 0.01);
  const std::vector<std::uint32_t> touched{300};
  grow_patch(at.model, Neighbours(at.model, {}), at.positions, touched, at.positions[300], 600,
             at.patch);
  REQUIRE(at.patch.nodes.size() == 600);
  const auto p = at.direction();
  testing::ChunkThreads team(2);
  std::vector<std::vector<Vec4f>> found;
  std::vector<double> curvatures;
  for (ChunkRunner* const runner :
       {static_cast<ChunkRunner*>(nullptr), static_cast<ChunkRunner*>(&team)}) {
    PatchProduct product(at.springs, runner);
    product.take(at.patch);
    for (std::size_t i = 0; i < p.size(); ++i) product.nodes()[i].vector = p[i];
    found.emplace_back(p.size());
    curvatures.push_back(product.apply(found.back()));
  }
  CHECK(found[0] == found[1]);
  CHECK(curvatures[0] == curvatures[1]);
  grow_patch(at.model, Neighbours(at.model, {}), at.positions, touched, at.positions[300], 0,
             at.patch);
  PatchProduct none(at.springs);
  none.take(at.patch);
  std::vector<Vec4f> nothing;
  CHECK(none.apply(nothing) == 0);
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
  product.take(at.patch);
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
