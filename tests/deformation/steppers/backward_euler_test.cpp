#include "deformation/steppers/backward_euler.h"
#include "deformation/organ_messages.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "deformation/steppers/symplectic_euler.h"
#include "studies/rigs/pressed_organ.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

using testing::ball_organ;
using testing::ball_scene;
using testing::kBallRadius;
using testing::plate_contacts;

constexpr double kImplicitStep = 0.01;

/// Organ between two plates that close to `compression` in a second and hold for another.
struct Press {
  double worst_volume_error = 0, held_volume_error = 0, pressure = 0;
  double upper_force = 0, lower_force = 0, least_force = 0, penetration = 0;
};

Press press(scene::Organ organ, scene::Integrator integrator, double compression, double period) {
  organ.integrator = integrator;
  DeformationWorld world(ball_scene(2, organ), {geometry::make_ball(kBallRadius, 3)});
  Press result;
  NodePositions nodes;
  ContactModel upper, lower;
  const int moving = static_cast<int>(1 / period);
  for (int cycle = 1; cycle <= 2 * moving; ++cycle) {
    const double height = kBallRadius * (1 - compression * std::min(1.0, cycle / double(moving)));
    for (std::uint32_t probe = 0; probe < 2; ++probe) {
      const int side = probe == 0 ? 1 : -1;
      world.set_contacts(plate_contacts(world, probe, side * height, side, 2e-3));
      world.set_probe(probe, Pose{Vec3(0, 0, side * height), Quat::Identity()});
    }
    const AdvanceReport report = world.advance(period);
    CHECK_FALSE(report.diverged);
    deformation::write_node_positions(world, 0, nodes);
    upper = deformation::contact_model_message(world, 0);
    lower = deformation::contact_model_message(world, 1);
    result.held_volume_error = std::abs(nodes.volume / nodes.target_volume - 1);
    result.worst_volume_error = std::max(result.worst_volume_error, result.held_volume_error);
    result.least_force = std::min({result.least_force, upper.force().z(), -lower.force().z()});
  }
  for (std::size_t i = 2; i < 3 * deformation::surface_message(world, 0).surface_node_count;
       i += 3) {
    result.penetration = std::max(result.penetration,
                                  std::abs(nodes.positions[i]) - kBallRadius * (1 - compression));
  }
  result.pressure = nodes.pressure;
  result.upper_force = upper.force().z();
  result.lower_force = lower.force().z();
  return result;
}

TEST_CASE("backward Euler: plates feel the equilibrium of symplectic Euler") {
  // Oracle: symplectic Euler, and action = reaction. 1 %: which nodes touch at the rim of the
  // contact is decided by some 1e-5 m, a node's force is 1/300 of the sum.
  auto organ = ball_organ();
  organ.tissue.drag = 10;
  const auto expected = press(organ, scene::Integrator::kSymplecticEuler, 0.3, 4e-3);
  const auto found = press(organ, scene::Integrator::kBackwardEuler, 0.3, kImplicitStep);
  CHECK(found.upper_force == Approx(expected.upper_force).epsilon(0.01));
  CHECK(found.lower_force == Approx(-found.upper_force).epsilon(1e-3));
  CHECK(found.pressure == Approx(expected.pressure).epsilon(0.01));
  CHECK(found.least_force >= 0);
  CHECK(found.penetration < 1e-7);
}

TEST_CASE("backward Euler: the volume holds under plates at 10 ms with one correction") {
  // Oracle: the bounds asked of the method, 1e-5 on the way to 50 % and 1e-8 held.
  auto organ = ball_organ();
  organ.tissue.drag = 10;
  organ.volume_corrections = 1;
  const auto found = press(organ, scene::Integrator::kBackwardEuler, 0.5, kImplicitStep);
  CHECK(found.worst_volume_error < 1e-5);
  CHECK(found.held_volume_error < 1e-8);
}

TEST_CASE("backward Euler: a sphere inflated to V* holds the pressure of symplectic Euler") {
  // Oracle: symplectic Euler, tested against Laplace's law.
  auto organ = ball_organ();
  organ.tissue.drag = 30;
  const auto model = testing::ball_model(2, organ);
  BackwardEuler implicit(model);
  auto symplectic = testing::constrained(model);
  const auto inflate = [&](OrganDynamics& dynamics, double h) {
    auto state = rest_state(model);
    const int steps = static_cast<int>(2 / h);
    for (int s = 1; s <= steps; ++s) {
      state.target_volume = model.rest_volume * (1 + 0.15 * std::min(1.0, 2.0 * s / steps));
      dynamics.step(h, {}, state);
    }
    return state.pressure;
  };
  CHECK(inflate(implicit, kImplicitStep) == Approx(inflate(symplectic, 1e-3)).epsilon(1e-4));
}

TEST_CASE("backward Euler: a free organ falls by g h² n(n+1)/2, and drag slows it") {
  // Oracle: analytic, exact for the scheme: v⁺ = (v + h g)/(1 + h α). Iterations end when they
  // could change no velocity by more than 1e-7 m/s.
  auto organ = ball_organ();
  organ.tissue.drag = 0;
  const Vec3 gravity(0, 0, -9.81);
  const auto falling = testing::ball_model(1, organ, gravity);
  auto state = rest_state(falling);
  BackwardEuler dynamics(falling);
  const int steps = 50;
  for (int s = 0; s < steps; ++s) dynamics.step(kImplicitStep, {}, state);
  const Vec3 fall = 0.5 * steps * (steps + 1) * kImplicitStep * kImplicitStep * gravity;
  for (std::size_t i = 0; i < falling.node_count(); ++i) {
    CHECK((state.positions[i] - falling.rest_positions[i] - fall).norm() < 1e-7);
  }
  organ.tissue.drag = 5;
  const auto drifting = testing::ball_model(1, organ);
  state = rest_state(drifting);
  for (Vec3& v : state.velocities) v = Vec3(1, 0, 0);
  BackwardEuler slowed(drifting);
  for (int s = 0; s < steps; ++s) slowed.step(kImplicitStep, {}, state);
  for (const Vec3& v : state.velocities) {
    CHECK(v.x() == Approx(std::pow(1 + 5 * kImplicitStep, -steps)).margin(1e-6));
  }
}

TEST_CASE("backward Euler: without forces from outside momentum is kept, however few iterations") {
  // Oracle: invariant, volume constraint on and springs swinging.
  auto organ = ball_organ();
  organ.tissue.drag = 0;
  const auto model = testing::ball_model(3, organ);
  auto state = rest_state(model);
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      sum += model.masses[i] * state.velocities[i];
    }
    return sum;
  };
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3& p = model.rest_positions[i];
    state.velocities[i] = Vec3(0.1 + p.y(), 3 * p.z(), -p.x());
  }
  const Vec3 before = momentum();
  BackwardEuler dynamics(model, {}, 3);
  for (int s = 0; s < 100; ++s) dynamics.step(kImplicitStep, {}, state);
  CHECK((momentum() - before).norm() < 1e-12);
}

TEST_CASE("backward Euler: fixed nodes stay, a resting organ stays and costs no iterations") {
  // Oracle: invariant. Floats know the ball's nodes and springs to a few 1e-9 m.
  auto organ = ball_organ();
  organ.fixed.push_back(scene::SphereRegion{Vec3(0, 0, 0.05), 0.03});
  auto model = testing::ball_model(2, organ);
  auto state = rest_state(model);
  BackwardEuler dynamics(model);
  for (int s = 0; s < 100; ++s) dynamics.step(kImplicitStep, {}, state);
  CHECK(dynamics.iterations_used() == 0);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    CHECK((state.positions[i] - model.rest_positions[i]).norm() < 2e-8);
  }
  // All of them: nothing can move, nor can the volume.
  std::fill(model.inverse_masses.begin(), model.inverse_masses.end(), 0);
  BackwardEuler held(model);
  state = rest_state(model);
  state.target_volume = 1.1 * model.rest_volume;
  CHECK(held.step(kImplicitStep, {}, state).volume_skipped);
  CHECK(state.pressure == 0);
  for (const Vec3& v : state.velocities) CHECK(v.isZero(0));
}

/// Rows that hold every surface node against planes moving inward at `speed`.
std::vector<ContactRow> rows_on_all_nodes(const OrganModel& model, double speed, double friction) {
  std::vector<ContactRow> rows;
  for (std::uint32_t i = 0; i < model.surface_node_count; ++i) {
    ContactRow row;
    row.nodes = {i, i, i};
    row.weights = Vec3(1, 0, 0);
    row.normal = model.rest_positions[i].normalized();
    row.probe_velocity = -speed * row.normal;
    row.friction = friction;
    rows.push_back(row);
  }
  return rows;
}

TEST_CASE("backward Euler: all nodes in contact, against the volume, stays finite") {
  // Oracle: no contact pulls, friction within its cone, nothing but numbers.
  const auto model = testing::ball_model(2);
  auto state = rest_state(model);
  BackwardEuler dynamics(model);
  auto rows = rows_on_all_nodes(model, 0.05, 0.2);
  for (int s = 0; s < 20; ++s) {
    dynamics.step(kImplicitStep, rows, state);
    CHECK(std::isfinite(state.pressure));
    for (const ContactRow& row : rows) {
      CHECK(row.normal_impulse >= 0);
      CHECK(row.tangential_impulse.norm() <= row.friction * row.normal_impulse * (1 + 1e-9));
    }
    for (const Vec3& x : state.positions) REQUIRE(x.allFinite());
  }
}

TEST_CASE("backward Euler: where the pressure is capped, friction starts from the step before") {
  // Oracle: continuity. A cap that takes 1e-6 of the pressure changes the step by as little; the
  // friction of rows that stick would double if it started from a first try's.
  const auto model = testing::ball_model(2);
  const auto push = [&](double pressure_limit) {
    auto state = rest_state(model);
    BackwardEuler dynamics(model);
    auto rows = rows_on_all_nodes(model, 0.02, 5);
    rows.resize(rows.size() / 4);
    for (ContactRow& row : rows) row.probe_velocity += 1e-3 * row.normal.unitOrthogonal();
    state.pressure_limit = pressure_limit;
    dynamics.step(kImplicitStep, rows, state);
    return std::pair(rows, state.pressure);
  };
  const auto [expected, pressure] = push(std::numeric_limits<double>::infinity());
  const auto [found, capped] = push((1 - 1e-6) * std::abs(pressure));
  CHECK(std::abs(capped) < std::abs(pressure));
  double difference = 0, friction = 0;
  for (std::size_t r = 0; r < found.size(); ++r) {
    difference += (found[r].tangential_impulse - expected[r].tangential_impulse).norm();
    friction += expected[r].tangential_impulse.norm();
  }
  CHECK(friction > 0);
  CHECK(difference < 0.01 * friction);
}

TEST_CASE("backward Euler: a free organ gets what its rough probe feels, however few iterations") {
  // Oracle: momentum, to rounding; a plate pressed in and drawn along, on walls coarse and fine.
  // No node is deeper in it than a contact that is not solved.
  auto organ = ball_organ();
  organ.tissue.drag = 0;
  const auto model = testing::ball_model(GENERATE(2, 4, 5), organ);
  const double friction = GENERATE(0.0, 0.3, 5.0);
  auto state = rest_state(model);
  BackwardEuler dynamics(model);
  const Vec3 velocity(0.04, 0, -0.04);
  double height = kBallRadius;
  for (int s = 0; s < 40; ++s) {
    std::vector<ContactRow> rows;
    for (std::uint32_t i = 0; i < model.surface_node_count; ++i) {
      const double gap = height - state.positions[i].z();
      if (gap > 2e-3) continue;
      ContactRow& row = rows.emplace_back();
      row.nodes = {i, i, i};
      row.weights = Vec3(1, 0, 0);
      row.gap = gap;
      row.friction = friction;
      row.probe_velocity = velocity;
    }
    Vec3 expected = testing::momentum(model, state);
    dynamics.step(kImplicitStep, rows, state);
    double pressed = 0, deepest = 0;
    for (const ContactRow& row : rows) {
      pressed += row.normal_impulse;
      expected += row.tangential_impulse - row.normal_impulse * row.normal;
      deepest = std::max(deepest, excess_depth(model, row, kImplicitStep, state.velocities));
    }
    CHECK((testing::momentum(model, state) - expected).norm() < 1e-9 * pressed + 1e-15);
    CHECK(deepest < kUnsolvedDepth);
    height += kImplicitStep * velocity.z();
  }
}

TEST_CASE("backward Euler: the same steps give the same bits") {
  // Oracle: itself, run twice, with contacts that stick and slide.
  const auto model = testing::ball_model(2);
  const auto run = [&] {
    auto state = rest_state(model);
    BackwardEuler dynamics(model);
    auto rows = rows_on_all_nodes(model, 0.02, 0.1);
    rows.resize(rows.size() / 4);
    for (int s = 0; s < 50; ++s) dynamics.step(kImplicitStep, rows, state);
    return state;
  };
  const auto first = run(), second = run();
  CHECK(first.positions == second.positions);
  CHECK(first.velocities == second.velocities);
  CHECK(first.pressure == second.pressure);
}

TEST_CASE("backward Euler: steps ten times its largest, from a wild state, stay finite and calm") {
  // Oracle: backward Euler damps: energy falls, whatever the step.
  const auto model = testing::ball_model(3);
  auto state = rest_state(model);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const auto k = static_cast<double>(i);
    state.velocities[i] = 2 * Vec3(std::sin(k), std::sin(2 * k), std::sin(3 * k));
  }
  BackwardEuler dynamics(model);
  for (int s = 0; s < 100; ++s) {
    dynamics.step(10 * kImplicitStep, {}, state);
    for (const Vec3& v : state.velocities) REQUIRE(v.allFinite());
  }
  double fastest = 0;
  for (const Vec3& v : state.velocities) fastest = std::max(fastest, v.norm());
  CHECK(fastest < 0.1);
}

TEST_CASE(
    "backward Euler: a fingertip held still comes to rest on a fine wall, whatever friction") {
  // Oracle: energy: drag and friction take it, nobody gives any. 0.5 %: what a swing leaves of a
  // press's 20 % by exp(−5/s t/2) in 3 s is 0.01 %.
  scene::Scene scene;
  scene::Organ organ = ball_organ();
  organ.tissue.youngs_modulus = 10e3;
  organ.tissue.drag = 5;
  organ.integrator = scene::Integrator::kBackwardEuler;
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.03)});
  scene.organs.push_back(organ);
  scene.rates.deformation = 100;
  const double friction = GENERATE(0.0, 0.1, 0.5);
  scene.probes.push_back({"tip", scene::SphereShape{0.008}, friction, scene::ScriptedDevice{}});
  geometry::OrganShape shape;
  shape.surface = geometry::make_ball(kBallRadius, 5);
  const auto at = [](double depth) {
    return Pose{Vec3(0.003, 0.002, kBallRadius + 0.008 - depth), Quat::Identity()};
  };
  rigs::PressedOrgan pressed(scene, shape, {at(0)});
  for (int i = 1; i <= 30; ++i) pressed.advance({at(2e-4 * i)});
  for (int i = 0; i < 300; ++i) pressed.advance({at(6e-3)});
  double least = pressed.force(0).z(), most = least;
  for (int i = 0; i < 30; ++i) {
    pressed.advance({at(6e-3)});
    least = std::min(least, pressed.force(0).z());
    most = std::max(most, pressed.force(0).z());
  }
  INFO("friction " << friction << ": " << least << " to " << most << " N");
  CHECK(least > 0);
  CHECK(most - least < 0.005 * most);
}

TEST_CASE("backward Euler: a flattened organ goes on without the volume and says so") {
  // Oracle: gᵀM⁻¹g = 0 with all nodes in one point.
  const auto model = testing::ball_model(1);
  auto state = rest_state(model);
  for (Vec3& x : state.positions) x.setZero();
  BackwardEuler dynamics(model);
  CHECK(dynamics.step(kImplicitStep, {}, state).volume_skipped);
  for (const Vec3& x : state.positions) CHECK(x.allFinite());
  CHECK(state.pressure == 0);
}

}  // namespace
}  // namespace palpate::deformation
