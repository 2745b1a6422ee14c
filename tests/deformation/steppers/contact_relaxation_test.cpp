#include "deformation/steppers/contact_relaxation.h"

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "deformation/springs/projected_spring_stiffness.h"
#include "studies/rigs/pressed_organ.h"
#include "tests/deformation/organs.h"
#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

constexpr double kLongStep = 0.06;  // so long that all of a small ball goes along

/// Rows on two triangles, pressing.
std::vector<ContactRow> some_rows(const OrganModel& model) {
  std::vector<ContactRow> rows(2);
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < 3; ++k) rows[i].nodes[k] = model.triangles[7 * i][k];
    rows[i].weights = Vec3(0.2, 0.3, 0.5);
    rows[i].normal = Vec3(0.6, 0, 0.8);
    rows[i].normal_impulse = 1e-3;
  }
  return rows;
}

TEST_CASE("contact relaxation: solves A Δ + Bᵀ λ = r, B Δ = 0 of the nodes about the rows") {
  // Oracle: the bordered matrix in double, its A by the springs' linearization, column by column.
  // All of a ball of 162 nodes goes along. Tolerance: conjugate gradients end at a hundredth of
  // the change, in the norm of A.
  scene::Organ organ = testing::ball_organ();
  organ.springs.inner_ratio = 0;  // no node but those of the surface
  const OrganModel model = testing::ball_model(2, organ);
  std::vector<Vec3> positions = model.rest_positions;
  for (Vec3& x : positions) x *= 1.05;
  ProjectedSpringStiffness springs(model, model.network());
  springs.linearise(positions, kLongStep);
  const std::size_t nodes = model.node_count();
  const auto size = static_cast<Eigen::Index>(3 * nodes);
  Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(size + 2, size + 2);
  for (Eigen::Index column = 0; column < size; ++column) {
    std::vector<Vec4f> p(nodes, Vec4f::Zero()), product(nodes, Vec4f::Zero());
    p[static_cast<std::size_t>(column / 3)][column % 3] = 1;
    springs.apply(p, product);
    for (std::size_t i = 0; i < nodes; ++i) {
      bordered.block<3, 1>(static_cast<Eigen::Index>(3 * i), column) =
          product[i].head<3>().cast<double>();
    }
  }
  std::vector<ContactRow> rows = some_rows(model);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows[r].friction = 0;  // slides: a row along its normal alone
    const auto at = size + static_cast<Eigen::Index>(r);
    for (int k = 0; k < 3; ++k) {
      const Vec3 arm = rows[r].weights[k] * rows[r].normal;
      const auto node = static_cast<Eigen::Index>(3 * rows[r].nodes[static_cast<std::size_t>(k)]);
      bordered.block<3, 1>(node, at) += arm;
      bordered.block<1, 3>(at, node) += arm.transpose();
    }
  }
  std::vector<Vec3> residual(nodes, Vec3::Zero());
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size + 2);
  for (std::size_t i = 0; i < nodes; ++i) {
    residual[i] = 1e-4 * positions[i].cross(Vec3(1, 2, 3));
    right.segment<3>(static_cast<Eigen::Index>(3 * i)) = residual[i];
  }
  const Eigen::VectorXd exact = solved(bordered, right);

  std::vector<Mat3> inverse_blocks;
  for (const Mat3& block : springs.diagonal()) inverse_blocks.push_back(block.inverse());
  SpringHessianProduct product(model, model.network(), false);
  product.linearise(positions, kLongStep);
  ContactRelaxation relaxation(model, product);
  REQUIRE(relaxation.choose(kLongStep, positions, rows));
  REQUIRE(relaxation.nodes().size() == nodes);
  relaxation.solve(inverse_blocks, residual, rows);
  Eigen::VectorXd found(size);
  for (std::size_t i = 0; i < nodes; ++i) {
    found.segment<3>(static_cast<Eigen::Index>(3 * relaxation.nodes()[i])) =
        relaxation.change()[i].head<3>().cast<double>();
  }
  const auto A = bordered.topLeftCorner(size, size);
  const Eigen::VectorXd lack = found - exact.head(size);
  CHECK(lack.dot(A * lack) < 1e-3 * exact.head(size).dot(A * exact.head(size)));
  for (Eigen::Index r = 0; r < 2; ++r) {
    CHECK(std::abs(bordered.row(size + r).head(size).dot(found)) < 1e-5 * found.norm());
    CHECK(rows[static_cast<std::size_t>(r)].normal_impulse - 1e-3 ==
          Approx(exact[size + r]).margin(0.03 * exact.tail(2).norm()));
  }
}

TEST_CASE("contact relaxation: no rows, or more than is local, are left alone") {
  // Oracle: the stated behaviour.
  const OrganModel model = testing::ball_model(4);  // 2,562 nodes
  SpringHessianProduct product(model, model.network(), false);
  product.linearise(model.rest_positions, kLongStep);
  ContactRelaxation relaxation(model, product);
  std::vector<ContactRow> rows;
  CHECK_FALSE(relaxation.choose(kLongStep, model.rest_positions, rows));
  rows.resize(ContactRelaxation::kMostTouched + 1);
  for (std::uint32_t i = 0; i < rows.size(); ++i) {
    rows[i].nodes = {i, 0, 0};
    rows[i].weights = Vec3::UnitX();
    rows[i].normal_impulse = 1;
  }
  CHECK_FALSE(relaxation.choose(kLongStep, model.rest_positions, rows));
}

/// A ball pressed by another at 20 mm/s, in steps of 10 ms that are truncated before the far end of
/// what moves.
struct BallOnBall {
  static constexpr double kWay = 2e-4;  ///< in a period [m]
  scene::Scene scene;
  geometry::OrganShape shape;
  double radius = 0;                   ///< of the probe [m]
  double size = testing::kBallRadius;  ///< of the organ, its radius [m]

  BallOnBall(int levels, double probe_radius) : radius(probe_radius) {
    scene::Organ organ = testing::ball_organ();
    organ.tissue.youngs_modulus = 10e3;
    organ.integrator = scene::Integrator::kBackwardEuler;
    organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.03)});
    scene.organs.push_back(organ);
    scene.rates.deformation = 100;
    scene.probes.push_back({"tip", scene::SphereShape{radius}, 0.1, scene::ScriptedDevice{}});
    shape.surface = geometry::make_ball(testing::kBallRadius, levels);
  }
  Pose at(double depth) const {
    return {Vec3(0.003, 0.002, size + radius - depth), Quat::Identity()};
  }
  double force_after(int periods, double last) const {
    rigs::PressedOrgan pressed(scene, shape, {at(-kWay)});
    for (int i = 0; i < periods; ++i) pressed.advance({at(i * kWay)});
    pressed.advance({at((periods - 1) * kWay + last)});
    return pressed.force(0).z();
  }
};

TEST_CASE("contact relaxation: many nodes under a probe are no stiffer than few") {
  // Oracle: the same ball of a quarter of the nodes. On the finer one more than 400 are touched.
  const auto pressed_force = [](int levels) {
    BallOnBall small(levels, 0.01);
    small.size = 0.02;
    small.shape.surface = geometry::make_ball(small.size, levels);
    small.scene.organs[0].fixed = {scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.012)}};
    rigs::PressedOrgan pressed(small.scene, small.shape, {small.at(-5e-4)});
    double most = 0;
    for (int i = 0; i < 24; ++i) {
      pressed.advance({small.at(i * 5e-4)});
      most = std::max(most, pressed.force(0).z());
    }
    return most;
  };
  const double coarse = pressed_force(4), fine = pressed_force(5);
  INFO(coarse << " N, finer " << fine << " N");
  CHECK(fine == Approx(coarse).epsilon(0.05));  // 1.8 % by the mesh, 10 % with 400 nodes at most
}

TEST_CASE("contact relaxation: on a fine wall a probe that slows feels less, not more") {
  // Oracle: a wall pushes no harder on a probe that comes less far. A ball of 10,242 nodes whose
  // steps of 10 ms are truncated before the far end of what moves: without the relaxation a press
  // slowed to a half is pushed back 1.7 times as hard after 20 periods.
  const BallOnBall press(5, 0.008);
  const double way = BallOnBall::kWay;
  for (const int periods : {10, 20}) {
    const double slowed = press.force_after(periods, way / 2),
                 even = press.force_after(periods, way),
                 faster = press.force_after(periods, 1.5 * way);
    INFO(periods << " periods: " << slowed << ", " << even << ", " << faster << " N");
    CHECK(slowed < even);
    CHECK(even < faster);
  }
}

}  // namespace
}  // namespace palpate::deformation
