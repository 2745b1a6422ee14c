// Organs put into shapes no organ comes into. Each case first lets the bare dynamics fail, then the
// guarded organ recover. shape_error() is over the cube root of the volume, 8 cm here.
#include <catch2/catch.hpp>
#include <random>

#include "tests/robustness/organs_under_test.h"

namespace palpate::deformation {
namespace {

using testing::ball_with;
using testing::run;
using testing::shape_error;
using testing::simulated_ball;
using testing::volume_error;

constexpr double kBackTime = 5.0;    // [s]
constexpr double kBackShape = 2e-3;  // 0.16 mm
constexpr double kBackVolume = 1e-8;

scene::Integrator any_integrator() {
  return GENERATE(scene::Integrator::kSymplecticEuler, scene::Integrator::kBackwardEuler);
}

OrganState flattened(const SimulatedOrgan& organ, const Vec3& keep) {
  OrganState state = organ.state();
  for (Vec3& p : state.positions) p = p.cwiseProduct(keep);
  return state;
}

/// gᵀM⁻¹g over its rest value.
double denominator(const OrganModel& model, const OrganState& state) {
  VolumeGradient volume;
  evaluate_volume(model, state.positions, volume);
  return volume.denominator / model.rest_denominator;
}

/// The dynamics alone, its target the rest volume, for `seconds`.
OrganState unguarded(const SimulatedOrgan& organ, OrganState state, double seconds) {
  const int substeps = organ.substeps(testing::kPeriod);
  state.target_volume = organ.model().rest_volume;
  for (double time = 0; time < seconds; time += testing::kPeriod) {
    for (int s = 0; s < substeps; ++s) {
      organ.dynamics().step(testing::kPeriod / substeps, {}, state);
    }
  }
  return state;
}

void check_back(const SimulatedOrgan& organ) {
  CHECK(shape_error(organ) < kBackShape);
  CHECK(volume_error(organ) < kBackVolume);
}

TEST_CASE("shape faults: a ball flattened to a disc comes back by itself") {
  // Oracle: g of a flattened sphere is the part of it along the one direction left, n_z² = ⅓ on
  // average; the volume follows at its rate, from 0.
  auto organ = simulated_ball(3, ball_with(any_integrator()));
  const OrganState flat = flattened(organ, Vec3(1, 1, 0));
  CHECK(denominator(organ.model(), flat) == Approx(1.0 / 3).epsilon(1e-6));
  organ.put(flat);
  const auto story = run(organ, kBackTime);
  CHECK(story.finite);
  CHECK(story.replaced == 0);
  CHECK_FALSE(story.volume_skipped);
  CHECK(story.fastest < 5);
  check_back(organ);
}

TEST_CASE("shape faults: a ball flattened at once to its full volume bursts") {
  // Oracle: Φ/h² of the whole volume asked for in one step: why V* begins at the volume there is.
  const auto organ = simulated_ball(3, ball_with(scene::Integrator::kSymplecticEuler));
  const OrganState after = unguarded(organ, flattened(organ, Vec3(1, 1, 0)), testing::kPeriod);
  double fastest = 0;
  for (const Vec3& v : after.velocities) fastest = std::max(fastest, v.norm());
  CHECK(fastest > 5);
}

TEST_CASE("shape faults: a ball collapsed to a line or a point is put back") {
  // Oracle: every triangle has no area, so g = 0, and by symmetry no spring pulls off the line.
  auto organ = simulated_ball(3, ball_with(any_integrator()));
  const Vec3 keep = GENERATE(Vec3(1, 0, 0), Vec3(0, 0, 0));
  const OrganState line = flattened(organ, keep);
  CHECK(denominator(organ.model(), line) < 1e-30);

  const OrganState stays = unguarded(organ, line, 2);
  for (const Vec3& p : stays.positions) REQUIRE(std::hypot(p.y(), p.z()) < 1e-12);

  organ.put(line);
  const auto story = run(organ, kBackTime);
  CHECK(story.volume_skipped);
  CHECK(story.first_reason == Violation::kCollapsed);
  CHECK(story.replaced == 1);
  CHECK(story.finite);
  check_back(organ);
}

TEST_CASE("shape faults: an everted ball is put back, not blown up") {
  // Oracle: mirrored, every spring has its rest length, so nothing turns the ball back; the bare
  // constraint asks for 2 V₀ in one step.
  auto organ = simulated_ball(3, ball_with(any_integrator()));
  const double size = GENERATE(1.0, 0.5);
  OrganState everted = organ.state();
  for (Vec3& p : everted.positions) p *= -size;
  const OrganState bare = unguarded(organ, everted, testing::kPeriod);
  double fastest = 0;
  for (const Vec3& v : bare.velocities) fastest = std::max(fastest, v.norm());
  CHECK(fastest > 5);

  organ.put(everted);
  const auto story = run(organ, kBackTime);
  CHECK(story.first_reason == Violation::kTurnedInside);
  CHECK(story.replaced == 1);
  // At rest float forces keep an organ swinging by 1e-8 m (decision 5), at 2/h at most.
  CHECK(story.fastest < 1e-8 * 2 / stable_step_bound(organ.model()));
  check_back(organ);
}

TEST_CASE("shape faults: from random positions volume and shape come back") {
  // Oracle: the only equilibrium without outside forces that was ever reached is the rest shape.
  auto organ = simulated_ball(3, ball_with(any_integrator()));
  std::mt19937 random(GENERATE(1u, 2u, 3u));
  const double reach = GENERATE(0.3, 1.0);
  std::uniform_real_distribution<double> any(-reach * testing::kBallRadius,
                                             reach * testing::kBallRadius);
  OrganState state = organ.state();
  for (Vec3& p : state.positions) {
    p = (1 - reach) * p + Vec3(any(random), any(random), any(random));
  }
  organ.put(state);
  const auto story = run(organ, 8);
  CHECK(story.finite);
  CHECK(story.to_rest == 0);
  check_back(organ);
}

TEST_CASE("shape faults: twisted by a full turn, thrown and spun, an organ calms down") {
  // Oracle: invariant; drag takes speed, springs the twist.
  auto organ = simulated_ball(3, ball_with(any_integrator()));
  OrganState state = organ.state();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    Vec3& p = state.positions[i];
    const double height = p.z() / testing::kBallRadius;
    state.velocities[i] = Vec3(30, 0, 0) + Vec3(0, 0, 100 * height).cross(p);
    p = Eigen::AngleAxisd(M_PI * height, Vec3::UnitZ()) * p;
  }
  organ.put(state);
  const auto story = run(organ, kBackTime);
  CHECK(story.finite);
  CHECK(story.replaced == 0);
  check_back(organ);
}

TEST_CASE("shape faults: an organ spun until it tears is put back") {
  // Oracle: springs of stiffness k do not hold m ω² > k; the speed of a node bounds nothing here,
  // the size does.
  auto organ = simulated_ball(3, ball_with(any_integrator()));
  OrganState state = organ.state();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    state.velocities[i] = Vec3(0, 0, 600).cross(state.positions[i]);
  }
  organ.put(state);
  const auto story = run(organ, kBackTime);
  CHECK(story.replaced >= 1);
  CHECK(story.first_reason == Violation::kTooLarge);
  CHECK(story.finite);
  check_back(organ);
}

TEST_CASE("shape faults: an organ of one tetrahedron lives") {
  // Oracle: 4 nodes, 4 triangles, no node two edges away.
  auto scene = ball_with(any_integrator());
  scene.springs.virtual_nodes = GENERATE(std::size_t{0}, std::size_t{1});
  auto organ = testing::simulate(scene, geometry::make_tetrahedron(0.05));
  OrganState state = organ.state();
  state.positions[0] *= 1.5;
  state.positions[1] = Vec3(0.01, 0.02, -0.03);
  organ.put(state);
  const auto story = run(organ, kBackTime);
  CHECK(story.finite);
  check_back(organ);
}

}  // namespace
}  // namespace palpate::deformation
