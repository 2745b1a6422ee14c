#include "deformation/steppers/xpbd_springs.h"

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "deformation/steppers/symplectic_euler.h"
#include "squeeze.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

scene::Organ spring_ball(double drag) {
  auto organ = testing::ball_organ();
  organ.model = "xpbd_springs";
  organ.tissue.drag = drag;
  return organ;
}

/// Springs one after another on a tetrahedron, whose other nodes are held; the volume is not kept.
OrganModel model_of_springs(const std::vector<double>& masses, std::vector<Spring> springs) {
  OrganModel model;
  model.surface_node_count = 4;
  model.network().structural_count = 1;
  model.network().bending_count = springs.size() - 1;
  for (std::size_t i = 0; i < 4; ++i) {
    model.rest_positions.emplace_back(0.01 * static_cast<double>(i), 0, 0);
    model.masses.push_back(i < masses.size() ? masses[i] : 1);
    model.inverse_masses.push_back(i < masses.size() ? 1 / masses[i] : 0);
  }
  model.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  model.network().damping.assign(springs.size(), 0);
  model.network().springs = std::move(springs);
  return model;
}

TEST_CASE("XPBD springs: alone, a damped spring is stepped by backward Euler exactly") {
  // Oracle: analytic. L⁺ (1 + h²kw + hcw) = L + hL' + hcw L, L the stretch, w = 1/m_a + 1/m_b.
  OrganModel model = model_of_springs({0.002, 0.003}, {{0, 1, 0.01, 400}});
  model.network().damping = {0.05};
  XpbdSprings xpbd(model, 1, {.is_kept = false});
  OrganState state = rest_state(model);
  state.positions[1].x() += 2e-3;
  const double h = 1e-3, w = 500 + 1 / 0.003, k = 400, c = 0.05;
  double stretch = 2e-3, rate = 0;
  for (int n = 0; n < 50; ++n) {
    xpbd.step(h, {}, state);
    const double next =
        (stretch + h * rate + h * c * w * stretch) / (1 + h * h * k * w + h * c * w);
    rate = (next - stretch) / h;
    stretch = next;
    REQUIRE(state.positions[1].x() - state.positions[0].x() - 0.01 ==
            Approx(stretch).margin(1e-12));
  }
}

TEST_CASE("XPBD springs: at rest drag bears nothing of the weight") {
  // Oracle: analytic. A mass on a spring stretches it by m g/k, whatever the drag; symplectic Euler
  // of a damped mass ends there to e^(−drag t/2).
  for (const double drag : {20.0, 100.0}) {
    OrganModel model = model_of_springs({1, 0.002}, {{0, 1, 0.01, 400}});
    model.inverse_masses[0] = 0;
    model.gravity = Vec3(9.81, 0, 0);
    model.drag = drag;
    XpbdSprings xpbd(model, 1, {.is_kept = false});
    OrganState state = rest_state(model);
    for (int n = 0; n < 6000; ++n) xpbd.step(XpbdSprings::kStep, {}, state);
    CHECK(state.positions[1].x() - 0.01 == Approx(0.002 * 9.81 / 400).epsilon(1e-6));
  }
}

TEST_CASE("XPBD springs: many passes make backward Euler's step of springs in a row") {
  // Oracle: analytic. (M/h² + K) Δ = M g for two springs hung up in a line, from rest.
  OrganModel model = model_of_springs({1, 0.002, 0.003}, {{0, 1, 0.01, 400}, {1, 2, 0.01, 300}});
  model.inverse_masses[0] = 0;
  model.gravity = Vec3(9.81, 0, 0);
  const double h = 5e-3;
  Eigen::Matrix2d matrix;
  matrix << 0.002 / (h * h) + 700, -300, -300, 0.003 / (h * h) + 300;
  const Eigen::Vector2d moved = matrix.inverse() * Eigen::Vector2d(0.002, 0.003) * 9.81;
  const auto error = [&](int passes) {
    XpbdSprings xpbd(model, passes, {.is_kept = false});
    OrganState state = rest_state(model);
    xpbd.step(h, {}, state);
    return std::hypot(state.positions[1].x() - 0.01 - moved[0],
                      state.positions[2].x() - 0.02 - moved[1]) /
           moved.norm();
  };
  CHECK(error(1) > 0.1);
  CHECK(error(4) < error(1) / 2);
  CHECK(error(200) < 1e-9);
}

TEST_CASE("XPBD springs: an organ at rest stays there") {
  // Rest lengths are rounded: what they leave is below 1e-12 m.
  const auto model = testing::ball_model(2, spring_ball(0));
  XpbdSprings xpbd(model);
  testing::check_stays_at_rest(model, xpbd, 1e-12);
}

TEST_CASE("XPBD springs: free fall with drag is symplectic Euler's") {
  const auto model = testing::ball_model(2, spring_ball(3), Vec3(1, 2, -9.81));
  XpbdSprings xpbd(model);
  testing::check_free_fall(model, xpbd, testing::DragOf::kBefore);
}

TEST_CASE("XPBD springs: a shaken organ keeps momentum and volume") {
  // Oracle: invariants. Volume is linearised once a step: of second order in what a step moves.
  const auto model = testing::ball_model(2, spring_ball(0));
  XpbdSprings xpbd(model);
  OrganState state = rest_state(model);
  Vec3 momentum = Vec3::Zero();
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3& x = state.positions[i];
    state.velocities[i] = Vec3(0.1 + 3 * x.y(), 2 * x.x() - x.z(), 5 * x.y() + 0.2);
    momentum += model.masses[i] * state.velocities[i];
  }
  for (int k = 0; k < 200; ++k) xpbd.step(XpbdSprings::kStep, {}, state);
  Vec3 after = Vec3::Zero();
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    after += model.masses[i] * state.velocities[i];
  }
  CHECK((after - momentum).norm() < 1e-12 * momentum.norm());
  CHECK(geometry::enclosed_volume(state.positions, model.triangles) ==
        Approx(model.rest_volume).epsilon(1e-5));
}

TEST_CASE("XPBD springs: squeezed, softer than the springs are, less so for shorter steps") {
  // Oracle: independent method, symplectic Euler at rest, which is at the springs' equilibrium.
  const auto model = testing::ball_model(2, spring_ball(10));
  const auto squeezed = [&](OrganDynamics& dynamics, double h) {
    struct Shorter : OrganDynamics {
      Shorter(OrganDynamics& by, double step) : inner(by), longest(step) {}
      double largest_step() const override { return longest; }
      StepReport step(double step, std::span<ContactRow> rows, OrganState& state) override {
        return inner.step(step, rows, state);
      }
      double elastic_energy(const OrganState& state) override {
        return inner.elastic_energy(state);
      }
      OrganDynamics& inner;
      double longest;
    } shorter(dynamics, h);
    testing::Squeeze squeeze(model, shorter, 0.05);
    const double force = squeeze.go_to(0.04, 0.1, 0.8);
    CHECK(squeeze.deepest() < 1e-6);
    return force;
  };
  auto symplectic = testing::constrained(model);
  XpbdSprings xpbd(model);
  const double wanted = squeezed(symplectic, 2e-4);
  const double error = squeezed(xpbd, XpbdSprings::kStep) / wanted - 1;
  const double error_halved = squeezed(xpbd, XpbdSprings::kStep / 2) / wanted - 1;
  std::printf("XPBD springs: force error %.2f %%, at half the step %.2f %%\n", 100 * error,
              100 * error_halved);
  CHECK(std::abs(error) < 0.05);
  CHECK(std::abs(error_halved) < std::abs(error) + 1e-3);
}

}  // namespace
}  // namespace palpate::deformation
