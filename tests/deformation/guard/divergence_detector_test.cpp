#include "deformation/guard/divergence_detector.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "deformation/steppers/symplectic_euler.h"
#include "tests/deformation/guard/torn_organ.h"
#include "tests/deformation/springs/chunk_threads.h"
#include "tests/deformation/volume/rules/method_checks.h"

namespace palpate::deformation {
namespace {

constexpr double kWatchedStep = 5e-4;
constexpr double kLong = 1;  // in which a node may come as far as the tests put it [s]

/// Rows of a plate that comes down on the ball's top at `speed` and is at `height` at the step's
/// start.
/// @param side  −1: on the ball's bottom, from below, at −height
std::vector<ContactRow> plate_rows(const OrganModel& model, const OrganState& state, double height,
                                   double speed, int side = 1) {
  std::vector<ContactRow> rows;
  for (std::uint32_t i = 0; i < model.surface_node_count; ++i) {
    if (side * model.rest_positions[i].z() < 0) continue;
    ContactRow row;
    row.nodes = {i, i, i};
    row.weights = Vec3(1, 0, 0);
    row.normal = Vec3(0, 0, side);
    row.gap = height - side * state.positions[i].z();
    row.probe_velocity = -speed * row.normal;
    rows.push_back(row);
  }
  return rows;
}

TEST_CASE("divergence detector: the energy budget bounds what a press puts in, and closely") {
  // Oracle: energy of an undamped ball. 1.5: first contact of a node is an impact, whose loss the
  // bound does not see.
  const auto organ = testing::undamped_ball_with("implicit_volume");
  const auto model = testing::ball_model(3, organ);
  auto dynamics = testing::constrained(model);
  DivergenceDetector detector(model, true);
  OrganState state = rest_state(model);
  detector.begin(state, 0);
  double height = testing::kBallRadius, energy = 0;
  constexpr double kSpeed = 0.1;
  for (int s = 0; s < 400; ++s) {
    auto rows = plate_rows(model, state, height, kSpeed);
    dynamics.step(kWatchedStep, rows, state);
    detector.add_work(kWatchedStep, rows, 0, state);
    height -= kWatchedStep * kSpeed;
    REQUIRE(detector.check(state, kWatchedStep, dynamics) == Violation::kNone);
    CHECK_FALSE(detector.suspicious());
    energy = dynamics.elastic_energy(state);
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      energy += model.masses[i] * state.velocities[i].squaredNorm() / 2;
    }
    // The energy of symplectic Euler swings with the step.
    REQUIRE(detector.energy_budget() > 0.95 * energy - 1e-7);
  }
  CHECK(energy > 1e-3);
  CHECK(detector.energy_budget() < 1.5 * energy);
}

TEST_CASE(
    "divergence detector: a probe at rest may push tissue out of itself once, not on and on") {
  // Oracle: a plate at rest does no work. Standing 5 mm deep it drives the cap out once; found
  // as deep in it in every step, now on this side, now on that, it would do so forever.
  const auto organ = testing::undamped_ball_with("mass_spring");
  const auto model = testing::ball_model(3, organ);
  for (const bool again : {false, true}) {
    auto dynamics = testing::constrained(model);
    DivergenceDetector detector(model, true);
    OrganState state = rest_state(model);
    detector.begin(state, 0);
    Violation seen = Violation::kNone;
    for (int s = 0; s < 4000 && seen == Violation::kNone; ++s) {
      double top = testing::kBallRadius;
      const int side = again && s / 25 % 2 == 1 ? -1 : 1;
      if (again) {
        top = -1;
        for (const Vec3& p : state.positions) top = std::max(top, side * p.z());
      }
      auto rows = plate_rows(model, state, top - 0.005, 0, side);
      dynamics.step(kWatchedStep, rows, state);
      detector.add_work(kWatchedStep, rows, 0, state);
      seen = detector.check(state, kWatchedStep, dynamics);
    }
    CHECK(seen == (again ? Violation::kEnergyGrew : Violation::kNone));
  }
}

TEST_CASE("divergence detector: what a probe crosses late is its own work, and injects nothing") {
  // Oracle: the same push by a probe at rest is work that nobody did; and an organ that flies as a
  // whole is not shaken, whatever was injected.
  const auto model = testing::ball_model(2);
  auto dynamics = testing::constrained(model);
  for (const bool moving : {false, true}) {
    for (const bool shakes : {false, true}) {
      DivergenceDetector detector(model, true);
      OrganState state = rest_state(model);
      detector.begin(state, 0);
      for (std::size_t i = 0; i < model.node_count(); ++i) {
        const int side = shakes && model.rest_positions[i].x() < 0 ? -1 : 1;
        state.velocities[i] = Vec3(1.5 * side * kShakenSpeed, 0, -0.9);
        state.positions[i] += kWatchedStep * state.velocities[i];
      }
      ContactRow row;
      row.weights = Vec3(1, 0, 0);
      row.normal_impulse = 20;  // times 0.9 m/s: more than the ball's mass times 1 m²/s²
      if (moving) {
        row.probe_velocity = Vec3(0, 0, -1);
        for (Vec3& v : state.velocities) v += row.probe_velocity;
      }
      detector.add_work(kWatchedStep, std::span(&row, 1), 0, state);
      CHECK(detector.check(state, kWatchedStep, dynamics) ==
            (shakes && !moving ? Violation::kEnergyGrew : Violation::kNone));
    }
  }
}

TEST_CASE("divergence detector: a pressure that moves the volume does work") {
  // Oracle: p dV.
  const auto model = testing::ball_model(1);
  DivergenceDetector detector(model, true);
  OrganState state = rest_state(model);
  detector.begin(state, 0.25);
  state.pressure = 100;
  detector.add_work(kWatchedStep, {}, 1e-5, state);
  CHECK(detector.energy_budget() == Approx(0.25 + 1e-3));
}

TEST_CASE("divergence detector: work that takes more than there is leaves nothing, not less") {
  // Oracle: no organ holds less than nothing, so what comes later is its own.
  const auto model = testing::ball_model(1);
  DivergenceDetector detector(model, true);
  OrganState state = rest_state(model);
  detector.begin(state, 0.1);
  state.pressure = 100;
  detector.add_work(kWatchedStep, {}, -1, state);
  detector.add_work(kWatchedStep, {}, 1e-5, state);
  CHECK(detector.energy_budget() == Approx(1e-3));
}

TEST_CASE("divergence detector: threads find what one finds, in every range of nodes, bit by bit") {
  // Oracle: itself on one thread, by all it remembers; and which node was put out of bounds.
  const auto model = testing::ball_model(4, testing::ball_organ(), Vec3(0, 0, -9.81));
  REQUIRE(model.node_count() > 2 * Ranges::kSize);
  auto dynamics = testing::constrained(model);
  testing::ChunkThreads threads(3);
  DivergenceDetector alone(model, true), shared(model, true, &threads);
  OrganState state = rest_state(model);
  for (DivergenceDetector* const detector : {&alone, &shared}) detector->begin(state, 0);
  for (int s = 0; s < 5; ++s) {
    dynamics.step(kWatchedStep, {}, state);
    std::vector<std::uint8_t> remembered;
    for (DivergenceDetector* const detector : {&alone, &shared}) {
      REQUIRE(detector->check(state, kWatchedStep, dynamics) == Violation::kNone);
      StateArchive archive;
      archive(*detector);
      if (detector == &alone) remembered = archive.bytes();
      CHECK(archive.bytes() == remembered);
    }
  }
  for (std::size_t node = 0; node < model.node_count(); node += Ranges::kSize / 2) {
    OrganState fast = state;
    fast.velocities[node].z() = 2 * kMaxNodeSpeed;
    CHECK(shared.check(fast, kWatchedStep, dynamics) == Violation::kTooFast);
    CHECK(shared.check(state, kWatchedStep, dynamics) == Violation::kNone);
  }
}

TEST_CASE("divergence detector: each kind of nonsense is told from the others") {
  // Oracle: definitions of Violation.
  const auto model = testing::ball_model(2);
  auto dynamics = testing::constrained(model);
  DivergenceDetector detector(model, true);
  const OrganState rest = rest_state(model);
  detector.begin(rest, 0);
  CHECK(detector.check(rest, kLong, dynamics) == Violation::kNone);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf}) {
    for (const std::size_t node : {std::size_t{0}, model.node_count() - 1}) {
      OrganState state = rest;
      state.positions[node].y() = bad;
      CHECK(detector.check(state, kLong, dynamics) == Violation::kNotFinite);
      state = rest;
      state.velocities[node].x() = bad;
      CHECK(detector.check(state, kLong, dynamics) == Violation::kNotFinite);
    }
    OrganState state = rest;
    state.pressure = bad;
    CHECK(detector.check(state, kLong, dynamics) == Violation::kNotFinite);
  }
  OrganState state = rest;
  state.velocities[5].x() = 1.01 * kMaxNodeSpeed;
  CHECK(detector.check(state, kLong, dynamics) == Violation::kTooFast);
  state = rest;  // slow now, but it has come a long way
  state.positions[5].x() += 1.01 * kMaxNodeSpeed * kWatchedStep;
  CHECK(detector.check(state, kWatchedStep, dynamics) == Violation::kTooFast);
  state.positions[5].x() -= 0.02 * kMaxNodeSpeed * kWatchedStep;
  CHECK(detector.check(state, kWatchedStep, dynamics) == Violation::kNone);
  state = rest;
  state.positions[5] += 2 * kMaxGrowth * Vec3(testing::kBallRadius, 0, 0);
  CHECK(detector.check(state, kLong, dynamics) == Violation::kTooLarge);
  state = rest;
  const double whole = 1 / std::sqrt(testing::moving_share(model));
  testing::tear(model, 1.01 * whole * kShakenSpeed, state);
  CHECK(detector.check(state, kLong, dynamics) == Violation::kEnergyGrew);
  detector.begin(rest, 0);
  testing::tear(model, 0.99 * whole * kShakenSpeed, state);
  CHECK(detector.check(state, kLong, dynamics) == Violation::kNone);
  CHECK(detector.suspicious());
  testing::tear(model, 2 * whole * kCalmSpeed, state);
  CHECK(detector.check(state, kLong, dynamics) == Violation::kNone);
  CHECK(detector.suspicious());
  state = rest;
  for (auto& p : state.positions) p = -p;
  CHECK(detector.check(state, kLong, dynamics) == Violation::kNone);
  CHECK(detector.check_thoroughly(state, kLong, dynamics) == Violation::kTurnedInside);
}

TEST_CASE("divergence detector: models that do not know their energy are not judged by it") {
  // Oracle: definition; speed and size still count.
  const auto model = testing::ball_model(1);
  auto dynamics = testing::constrained(model);
  DivergenceDetector detector(model, row_of("chainmail").knows_energy);
  OrganState state = rest_state(model);
  detector.begin(state, 0);
  testing::tear(model, 50, state);
  CHECK(detector.check(state, kLong, dynamics) == Violation::kNone);
  for (auto& v : state.velocities) v = Vec3(150, 0, 0);
  CHECK(detector.check(state, kLong, dynamics) == Violation::kTooFast);
}

TEST_CASE(
    "divergence detector: an impulse that is no number is a violation, whatever it left of the "
    "state") {
  // Oracle: IEEE arithmetic: without the check the energy budget would be no number for ever, and
  // any energy be less than that.
  const auto model = testing::ball_model(1);
  auto dynamics = testing::constrained(model);
  DivergenceDetector detector(model, true);
  const OrganState state = rest_state(model);
  detector.begin(state, 0);
  ContactRow row;
  row.weights = Vec3(1, 0, 0);
  row.tangential_impulse = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  detector.add_work(kWatchedStep, std::span(&row, 1), 0, state);
  CHECK(detector.check(state, kLong, dynamics) == Violation::kNotFinite);
  detector.begin(state, std::numeric_limits<double>::quiet_NaN());
  CHECK(detector.check(state, kLong, dynamics) == Violation::kNone);
}

}  // namespace
}  // namespace palpate::deformation
