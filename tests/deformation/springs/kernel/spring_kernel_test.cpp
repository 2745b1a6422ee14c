#include "deformation/springs/kernel/spring_kernel.h"

#include <array>
#include <catch2/catch.hpp>
#include <random>

#include "deformation/springs/spring_forces.h"
#include "deformation/steppers/symplectic_euler.h"
#include "tests/deformation/organs.h"
#include "tests/deformation/springs/chunk_threads.h"

namespace palpate::deformation {
namespace {

using testing::ball_model;
using testing::ball_organ;
using testing::ChunkThreads;

constexpr double kKernelStep = 3e-4;  // [s]

OrganState disturbed(const OrganModel& model, double amplitude) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  auto state = rest_state(model);
  for (auto& p : state.positions) p += amplitude * vector();
  for (auto& v : state.velocities) v = vector();
  return state;
}

scene::Organ loaded_organ() {
  auto organ = ball_organ();
  organ.fixed.push_back(scene::SphereRegion{Vec3(0, 0, 0.05), 0.02});
  organ.tissue.drag = 3;
  return organ;
}

/// Largest differences of what the kernel and the plain code say of one state, each over the size
/// of what was summed up.
struct Differences {
  double velocity = 0, gradient = 0, volume = 0, denominator = 0, volume_velocity = 0;
};

Differences from_plain(const OrganModel& model, const OrganState& state, InstructionSet set) {
  SpringKernel kernel(model, model.network(), true, nullptr, set);
  FreeStep fast;
  kernel.free_step(kKernelStep, state, fast);
  auto plain = state;
  std::vector<Vec3> forces;
  apply_forces(model, kKernelStep, plain, forces);
  VolumeGradient volume;
  evaluate_volume(model, state.positions, volume);

  // A force of a node is a sum over its springs, each k times a length: its rounding is of that.
  Differences worst;
  double speed = 0, area = 0, sum = 0;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const double kick = kKernelStep * model.inverse_masses[i] * model.node_stiffness[i] * 0.05;
    speed = std::max(speed, kick + state.velocities[i].norm());
    worst.velocity = std::max(worst.velocity, (fast.velocities[i] - plain.velocities[i]).norm());
  }
  worst.velocity /= speed;
  for (const Vec3& g : volume.gradient) area = std::max(area, g.norm());
  for (std::size_t i = 0; i < volume.gradient.size(); ++i) {
    const Vec3 difference = fast.volume.gradient[i] - volume.gradient[i];
    worst.gradient = std::max(worst.gradient, difference.norm() / area);
    sum += volume.gradient[i].dot(plain.velocities[i]);
  }
  worst.volume = std::abs(fast.volume.volume - volume.volume) / model.rest_volume;
  worst.denominator = std::abs(fast.volume.denominator - volume.denominator) / volume.denominator;
  worst.volume_velocity =
      std::abs(fast.volume_velocity - sum) / (area * speed * static_cast<double>(forces.size()));
  return worst;
}

/// How far the gradient may be off: 6e-8 for products, and for the positions of both ends of an
/// edge, which are rounded relative to the organ's extent.
double gradient_rounding(const OrganModel& model, const OrganState& state) {
  double extent = 0, shortest = 1;
  for (const auto& [a, b] : geometry::edges_of(model.triangles)) {
    extent = std::max(extent, (state.positions[a] - state.positions[0]).norm());
    shortest = std::min(shortest, (state.positions[a] - state.positions[b]).norm());
  }
  return 1.2e-7 * (1 + extent / shortest);
}

void check_agrees(const OrganModel& model, const OrganState& state) {
  // Sums of some twenty terms, each off by a few units in the last place: 6e-8 of the float's that
  // springs and gradient are in, 1e-16 of the volume's.
  for (const InstructionSet set : available_instruction_sets()) {
    INFO(name_of(set));
    const Differences difference = from_plain(model, state, set);
    CHECK(difference.velocity < 3e-7);
    CHECK(difference.gradient < gradient_rounding(model, state));
    CHECK(difference.volume < 1e-14);
    CHECK(difference.denominator < gradient_rounding(model, state));
    CHECK(difference.volume_velocity < 3e-7);
  }
}

TEST_CASE("spring kernel: the volume alone is that of the plain code, for any instruction set") {
  // Oracle: evaluate_volume(). All in double: sums of some hundred terms.
  const auto model = testing::ball_model(2);
  auto state = rest_state(model);
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    state.positions[i] *= 1 + 0.05 * std::sin(static_cast<double>(i));
    state.velocities[i] = Vec3(std::cos(static_cast<double>(i)), 0.3, -0.1);
  }
  VolumeGradient plain;
  evaluate_volume(model, state.positions, plain);
  for (const InstructionSet set : available_instruction_sets()) {
    INFO(name_of(set));
    SpringKernel kernel(model, model.network(), true, nullptr, set);
    FreeStep alone;
    alone.velocities = state.velocities;
    kernel.evaluate_volume(state.positions, alone);
    double rate = 0;
    for (std::size_t i = 0; i < plain.gradient.size(); ++i) {
      rate += plain.gradient[i].dot(state.velocities[i]);
      CHECK((alone.volume.gradient[i] - plain.gradient[i]).norm() <
            1e-14 * plain.gradient[i].norm());
    }
    CHECK(alone.volume.volume == Approx(plain.volume).epsilon(1e-14));
    CHECK(alone.volume.denominator == Approx(plain.denominator).epsilon(1e-14));
    CHECK(alone.volume_velocity == Approx(rate).epsilon(1e-13));
    CHECK(alone.velocities == state.velocities);
  }
}

TEST_CASE("spring kernel: agrees with the plain code to rounding, whatever the mesh size") {
  // Oracle: spring_forces.h and volume_constraint.h. 12 … 642 nodes: odd ends, one and many chunks.
  const auto model = ball_model(GENERATE(0, 1, 2, 3), loaded_organ(), Vec3(1, -2, -9.81));
  check_agrees(model, disturbed(model, 3e-3));
}

TEST_CASE("spring kernel: agrees without virtual nodes, bending springs or damping") {
  // Oracle: the plain code.
  auto organ = loaded_organ();
  SECTION("no virtual nodes") { organ.springs = {0.1, 0, 0}; }
  SECTION("one virtual node") { organ.springs.virtual_nodes = 1; }
  SECTION("no bending springs") { organ.springs.bending_ratio = 0; }
  SECTION("no damping") { organ.tissue.damping_ratio = 0; }
  const auto model = ball_model(2, organ);
  check_agrees(model, disturbed(model, 3e-3));
}

TEST_CASE("spring kernel: agrees on a tetrahedron and on a box whose corners have long rings") {
  // Oracle: the plain code. A tetrahedron has 4 nodes, no secondary neighbours, half a slice.
  auto organ = ball_organ();
  organ.springs = {0.1, 0.5, 1};
  const auto surface =
      GENERATE(geometry::make_tetrahedron(0.1), geometry::make_box(Vec3(0.1, 0.06, 0.08), 3),
               geometry::make_capsule(0.03, 0.1, 30));
  const auto model = build_organ_model(organ, Vec3::Zero(), surface);
  check_agrees(model, disturbed(model, 3e-3));
}

TEST_CASE("spring kernel: far from the origin the volume keeps its digits") {
  // Oracle: the same organ at the origin, moved by a number of binary fractions, so that the shift
  // itself loses 2^-36 m of the positions at most; that is 3e-10 of the radius.
  const auto model = ball_model(2);
  auto state = disturbed(model, 3e-3);
  SpringKernel kernel(model, model.network(), true);
  FreeStep here, there;
  kernel.free_step(kKernelStep, state, here);
  for (Vec3& p : state.positions) p += Vec3(65536, -32768, 16384);
  kernel.free_step(kKernelStep, state, there);
  CHECK(there.volume.volume == Approx(here.volume.volume).epsilon(3e-9));
  CHECK(there.volume.denominator == Approx(here.volume.denominator).epsilon(3e-9));
}

TEST_CASE("spring kernel: springs without length give no force and no NaN") {
  // Oracle: definition; all nodes in one point, at rest.
  const auto model = ball_model(1);
  auto state = rest_state(model);
  for (Vec3& p : state.positions) p = Vec3(0.1, 0.2, 0.3);
  for (const InstructionSet set : available_instruction_sets()) {
    SpringKernel kernel(model, model.network(), true, nullptr, set);
    FreeStep step;
    kernel.free_step(kKernelStep, state, step);
    for (const Vec3& v : step.velocities) CHECK(v == Vec3::Zero());
    CHECK(step.volume.volume == 0);
    CHECK(step.volume.denominator == 0);
  }
}

/// State after a few steps, and its pressure.
OrganState stepped(const OrganModel& model, InstructionSet set, ChunkRunner* runner) {
  auto state = disturbed(model, 2e-3);
  SpringKernel kernel(model, model.network(), true, runner, set);
  FreeStep step;
  for (int s = 0; s < 20; ++s) {
    kernel.free_step(kKernelStep, state, step);
    const double rate = (step.volume.volume - state.target_volume) / kKernelStep;
    const double sigma = (rate + step.volume_velocity) / step.volume.denominator;
    kernel.finish_step(kKernelStep, sigma, step, state);
    state.pressure = -sigma / kKernelStep;
  }
  return state;
}

bool same_bits(const OrganState& a, const OrganState& b) {
  return a.positions == b.positions && a.velocities == b.velocities && a.pressure == b.pressure;
}

TEST_CASE("spring kernel: the same bits for any number of threads") {
  // Oracle: itself on one thread.
  const auto model = ball_model(3, loaded_organ());
  for (const InstructionSet set : available_instruction_sets()) {
    INFO(name_of(set));
    const auto expected = stepped(model, set, nullptr);
    for (std::size_t threads = 1; threads <= 3; ++threads) {
      ChunkThreads runner(threads);
      CHECK(same_bits(stepped(model, set, &runner), expected));
    }
  }
}

TEST_CASE("spring kernel: the same bits for all instruction sets with fused multiply-add") {
  // Oracle: each other.
  const auto model = ball_model(GENERATE(1, 3), loaded_organ());
  const auto sets = available_instruction_sets();
  if (sets.size() < 3) {
    WARN("SKIPPED: this CPU has no two instruction sets with fused multiply-add");
    return;
  }
  CHECK(same_bits(stepped(model, sets[1], nullptr), stepped(model, sets[2], nullptr)));
}

TEST_CASE("spring kernel: internal forces keep momentum and angular momentum") {
  // Oracle: invariant. The two ends of a spring get the same force to the bit; the sums at the
  // nodes are rounded in float, and so is the volume's gradient.
  auto organ = ball_organ();
  organ.tissue.drag = 0;
  const auto model = ball_model(2, organ);
  const auto state = disturbed(model, 5e-3);
  SpringKernel kernel(model, model.network(), true);
  FreeStep step;
  kernel.free_step(kKernelStep, state, step);
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero(), volume = Vec3::Zero();
  double size = 0;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3 change = model.masses[i] * (step.velocities[i] - state.velocities[i]);
    momentum += change;
    angular += state.positions[i].cross(change);
    size += change.norm();
  }
  for (const Vec3& g : step.volume.gradient) volume += g;
  CHECK(momentum.norm() < 1e-7 * size);
  CHECK(angular.norm() < 1e-7 * size * testing::kBallRadius);
  CHECK(volume.norm() < 1e-7 * geometry::surface_area(state.positions, model.triangles));
}

TEST_CASE("spring kernel: without volume it is the same step") {
  // Oracle: itself with volume, which takes structural springs in the order of the rings: the sums
  // of float forces are rounded otherwise, to 3e-7 of what they give.
  auto organ = ball_organ();
  const auto model = ball_model(2, organ);
  const auto state = disturbed(model, 3e-3);
  for (const InstructionSet set : available_instruction_sets()) {
    FreeStep expected, found;
    SpringKernel(model, model.network(), true, nullptr, set)
        .free_step(kKernelStep, state, expected);
    SpringKernel(model, model.network(), false, nullptr, set).free_step(kKernelStep, state, found);
    double given = 0;
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      given = std::max(given, (expected.velocities[i] - state.velocities[i]).norm());
    }
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      CHECK((found.velocities[i] - expected.velocities[i]).norm() < 3e-7 * given);
    }
  }
}

TEST_CASE("spring kernel: elastic energy is that of the plain code") {
  // Oracle: elastic_energy(). At rest lengths cancel to their last bits: (1e-7 l)² k is 1e-17 J for
  // each of some thousand springs.
  auto organ = ball_organ();
  if (GENERATE(false, true)) organ.springs = {0.1, 0, 0};
  const auto model = ball_model(GENERATE(0, 2), organ);
  const auto state = disturbed(model, 3e-3);
  for (const InstructionSet set : available_instruction_sets()) {
    SpringKernel kernel(model, model.network(), true, nullptr, set);
    const double expected = elastic_energy(model.network(), state.positions);
    CHECK(kernel.elastic_energy(state.positions) == Approx(expected).epsilon(1e-6));
    CHECK(kernel.elastic_energy(model.rest_positions) < 1e-13);
  }
}

TEST_CASE(
    "spring kernel: symplectic Euler takes the plain step, contacts and corrections included") {
  // Oracle: symplectic_euler_step(). One step: chaos has no time. Velocities up to 2 m/s, springs
  // that change them by 0.1 m/s: floats leave 1e-7 of that.
  const int corrections = GENERATE(0, 1);
  const auto model = ball_model(2, loaded_organ());
  ContactRow row;
  row.nodes = model.triangles[40];
  row.weights = Vec3(0.2, 0.3, 0.5);
  row.normal = Vec3(0.6, 0, 0.8);
  row.gap = -1e-3;
  row.friction = 0.3;
  std::array<ContactRow, 1> fast_rows{row}, plain_rows{row};
  auto fast = disturbed(model, 2e-3), plain = fast;
  StepBuffers buffers;
  testing::constrained(model, corrections).step(kKernelStep, fast_rows, fast);
  symplectic_euler_step(model, kKernelStep, plain_rows, plain, buffers,
                        {.corrections = corrections});
  REQUIRE(plain_rows[0].normal_impulse > 0);
  CHECK(fast_rows[0].normal_impulse == Approx(plain_rows[0].normal_impulse).epsilon(1e-6));
  CHECK(fast.pressure == Approx(plain.pressure).epsilon(1e-6));
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    CHECK((fast.velocities[i] - plain.velocities[i]).norm() < 1e-6);
  }
}

}  // namespace
}  // namespace palpate::deformation
