#include "deformation/steppers/xpbd_tetrahedra.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "squeeze.h"

namespace palpate::deformation {
namespace {

scene::Organ tetrahedra_organ(double poisson_ratio, double drag) {
  auto organ = testing::reference_ball("xpbd_tetrahedra");
  organ.solid.poisson_ratio = poisson_ratio;
  organ.tissue.drag = drag;
  return organ;
}

TEST_CASE("XPBD tetrahedra: an organ at rest stays there") {
  // Its two constraints pull against each other: rounding, below 1e-12 m.
  for (const double poisson_ratio : {0.3, 0.499}) {
    const auto model = testing::block_model(tetrahedra_organ(poisson_ratio, 0), 3);
    XpbdTetrahedra xpbd(model, model.mesh());
    testing::check_stays_at_rest(model, xpbd, 1e-12);
  }
}

TEST_CASE("XPBD tetrahedra: free fall with drag is symplectic Euler's") {
  const auto model = testing::block_model(tetrahedra_organ(0.45, 3), 2, Vec3(1, 2, -9.81));
  XpbdTetrahedra xpbd(model, model.mesh());
  testing::check_free_fall(model, xpbd, testing::DragOf::kBefore);
}

TEST_CASE("XPBD tetrahedra: a shaken organ keeps its momentum and loses energy") {
  // Oracle: invariants; every visit moves four nodes by internal impulses.
  const auto model = testing::block_model(tetrahedra_organ(0.45, 0), 3);
  XpbdTetrahedra xpbd(model, model.mesh());
  OrganState state = rest_state(model);
  Vec3 momentum = Vec3::Zero();
  double energy = 0;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3& x = state.positions[i];
    state.velocities[i] = Vec3(0.1 + 3 * x.y(), 2 * x.x() - x.z(), 5 * x.y() + 0.2);
    momentum += model.masses[i] * state.velocities[i];
    energy += model.masses[i] * state.velocities[i].squaredNorm() / 2;
  }
  for (int k = 0; k < 400; ++k) xpbd.step(XpbdTetrahedra::kStep, {}, state);
  Vec3 after = Vec3::Zero();
  double left = xpbd.elastic_energy(state);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    after += model.masses[i] * state.velocities[i];
    left += model.masses[i] * state.velocities[i].squaredNorm() / 2;
  }
  CHECK((after - momentum).norm() < 1e-12 * momentum.norm());
  CHECK(left < energy);
}

TEST_CASE("XPBD tetrahedra: many passes end next to backward Euler's step") {
  // Oracle: what that step minimises, M/(2h²) |x − x̂|² + E(x): its slope, by differences of E,
  // beside that of E alone. Not zero: each pass pushes along gradients as they were then. Without
  // the multipliers in a pass, every further one would push anew.
  const auto model = testing::block_model(tetrahedra_organ(0.3, 0), 2);
  const double h = XpbdTetrahedra(model, model.mesh()).largest_step() / 2;
  const auto slope = [&](int passes) {
    XpbdTetrahedra xpbd(model, model.mesh(), passes);
    OrganState state = rest_state(model);
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      const Vec3& x = state.positions[i];
      state.velocities[i] = 20 * Vec3(x.y(), x.x(), -x.z());
    }
    std::vector<Vec3> predicted = state.positions;
    for (std::size_t i = 0; i < predicted.size(); ++i) predicted[i] += h * state.velocities[i];
    xpbd.step(h, {}, state);
    double sum = 0, elastic_alone = 0;
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        constexpr double kStep = 1e-7;
        OrganState up = state, down = state;
        up.positions[i][axis] += kStep;
        down.positions[i][axis] -= kStep;
        const double elastic = (xpbd.elastic_energy(up) - xpbd.elastic_energy(down)) / (2 * kStep);
        const double inertial =
            model.masses[i] * (state.positions[i][axis] - predicted[i][axis]) / (h * h);
        sum += (elastic + inertial) * (elastic + inertial);
        elastic_alone += elastic * elastic;
      }
    }
    return std::sqrt(sum / elastic_alone);
  };
  for (const int passes : {1, 2, 8, 100}) {
    INFO(passes);
    CHECK(slope(passes) < 1e-3);
  }
}

/// Kinetic energy after 500 steps of h over that of the kick.
double kept_of_kick(const OrganModel& model, XpbdTetrahedra& xpbd, double h) {
  OrganState state = rest_state(model);
  double kick = 0, left = 0;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const auto k = static_cast<double>(i);
    state.velocities[i] = 1e-3 * Vec3(std::sin(k), std::sin(2 * k), std::sin(3 * k));
    kick += model.masses[i] * state.velocities[i].squaredNorm();
  }
  for (int s = 0; s < 500; ++s) xpbd.step(h, {}, state);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    left += model.masses[i] * state.velocities[i].squaredNorm();
  }
  return left / kick;
}

TEST_CASE("XPBD tetrahedra: stiff tissue and fine meshes shorten the step") {
  // Oracle: dimension, h ~ a √(ρ/μ); the bound is stable, and three times it is not.
  auto organ = tetrahedra_organ(0.45, 0);
  const auto soft = testing::block_model(organ, 3);
  CHECK(XpbdTetrahedra(soft, soft.mesh()).largest_step() == XpbdTetrahedra::kStep);
  organ.tissue.youngs_modulus = 10e6;
  const auto coarse = testing::block_model(organ, 3), fine = testing::block_model(organ, 6);
  organ.tissue.youngs_modulus = 40e6;
  const auto stiff = testing::block_model(organ, 3);
  XpbdTetrahedra xpbd(coarse, coarse.mesh());
  const double h = xpbd.largest_step();
  CHECK(XpbdTetrahedra(fine, fine.mesh()).largest_step() == Approx(h / 2));
  CHECK(XpbdTetrahedra(stiff, stiff.mesh()).largest_step() == Approx(h / 2));
  CHECK(kept_of_kick(coarse, xpbd, h) < 1);
  CHECK_FALSE(kept_of_kick(coarse, xpbd, 3 * h) < 10);
}

TEST_CASE("XPBD tetrahedra: turned inside out, an organ finds back to its shape") {
  // Oracle: the shape at rest.
  const auto model = testing::block_model(tetrahedra_organ(0.45, 20), 2);
  XpbdTetrahedra xpbd(model, model.mesh());
  OrganState state = rest_state(model);
  state.positions[0] = -1.5 * state.positions[0];
  for (int k = 0; k < 2000; ++k) xpbd.step(XpbdTetrahedra::kStep, {}, state);
  CHECK(testing::rest_error(model, state) < 1e-4);
}

TEST_CASE("XPBD tetrahedra: a scene's word gives this method, and no other integrator") {
  // Oracle: the scene.
  auto organ = tetrahedra_organ(0.45, 0);
  const auto model = testing::block_model(organ, 1);
  CHECK(dynamic_cast<XpbdTetrahedra*>(make_dynamics(organ, model, 0.01).get()) != nullptr);
  organ.integrator = scene::Integrator::kBackwardEuler;
  CHECK_THROWS_AS(make_dynamics(organ, model, 0.01), InputError);
}

/// Force on a block of this ψ, pressed to a stretch along z and free across [N].
double block_force(double youngs_modulus, double nu, double stretch) {
  const double mu = youngs_modulus / (2 * (1 + nu)), lambda = mu * (2 * nu / (1 - 2 * nu) + 1);
  const auto hydrostatic = [&](double s) { return lambda * (s * s * stretch - 1 - mu / lambda); };
  double low = 1, high = 2;  // μ s + λ (J − 1 − μ/λ) s · stretch rises with s
  for (int k = 0; k < 100; ++k) {
    const double s = (low + high) / 2;
    (mu + hydrostatic(s) * stretch < 0 ? low : high) = s;
  }
  return -(mu * stretch + hydrostatic(low) * low * low) * 0.06 * 0.06;
}

TEST_CASE("XPBD tetrahedra: a block between smooth plates nears the formula as steps shorten") {
  // Oracle: analytic; the deformation is homogeneous, so the mesh adds no error. One visit errs
  // by h²ω² of an element: a fourth at half the step.
  const auto organ = tetrahedra_organ(0.45, 20);
  const auto model = testing::block_model(organ, 2);
  const double wanted = block_force(5e3, 0.45, 0.8);
  std::array<double, 2> errors{};
  for (const int k : {0, 1}) {
    struct Shorter : XpbdTetrahedra {
      Shorter(const OrganModel& of, double step) : XpbdTetrahedra(of, of.mesh()), longest(step) {}
      double largest_step() const override { return longest; }
      double longest;
    } xpbd(model, XpbdTetrahedra::kStep / (k + 1));
    testing::Squeeze squeeze(model, xpbd, 0.03);
    errors[static_cast<std::size_t>(k)] = squeeze.go_to(0.03 * 0.8, 0.1, 1.0) / wanted - 1;
    CHECK(squeeze.deepest() < 1e-6);
  }
  std::printf("XPBD tetrahedra: force error %.2f %%, at half the step %.2f %%\n", 100 * errors[0],
              100 * errors[1]);
  CHECK(std::abs(errors[0]) < 0.05);
  CHECK(std::abs(errors[1]) < 0.5 * std::abs(errors[0]));
}

}  // namespace
}  // namespace palpate::deformation
