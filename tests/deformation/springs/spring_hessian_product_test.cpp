#include "deformation/springs/spring_hessian_product.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "deformation/springs/projected_spring_stiffness.h"
#include "tests/deformation/organs.h"
#include "tests/deformation/springs/chunk_threads.h"

namespace palpate::deformation {
namespace {

using testing::ball_model;
using testing::ball_organ;
using testing::ChunkThreads;

constexpr double kProductStep = 5e-3;  // [s]

std::vector<Vec3> disturbed_positions(const OrganModel& model, double amplitude) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto positions = model.rest_positions;
  for (Vec3& p : positions)
    p += amplitude * Vec3(uniform(random), uniform(random), uniform(random));
  return positions;
}

std::vector<Vec4f> directions(const OrganModel& model) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec4f> p;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    p.push_back(wide(Vec3(uniform(random), uniform(random), uniform(random))));
  }
  return p;
}

double apply(SpringHessianProduct& product, const std::vector<Vec4f>& p, std::vector<Vec4f>& out) {
  for (std::size_t i = 0; i < p.size(); ++i) product.nodes()[i].vector = p[i];
  return product.apply(out);
}

void check_agrees(const OrganModel& model) {
  const auto positions = disturbed_positions(model, 3e-3);
  const auto p = directions(model);
  ProjectedSpringStiffness plain(model, model.network());
  plain.linearise(positions, kProductStep);
  std::vector<Vec4f> expected(p.size()), found(p.size());
  plain.apply(p, expected);
  for (const InstructionSet set : available_instruction_sets()) {
    INFO(name_of(set));
    SpringHessianProduct fast(model, model.network(), true, nullptr, set);
    fast.linearise(positions, kProductStep);
    const double found_dot = apply(fast, p, found);
    CHECK(found_dot == Approx(dot(p, found)).epsilon(1e-5));
    for (std::size_t i = 0; i < p.size(); ++i) {
      // Couplings have eight binary digits: each of a node's terms is off by 2e-3 at most.
      const double size = plain.diagonal()[i].norm();
      CHECK((found[i] - expected[i]).norm() < 4e-3 * size);
      CHECK((fast.diagonal()[i] - plain.diagonal()[i]).norm() < 2e-3 * size);
    }
  }
}

TEST_CASE("spring product: agrees with the plain linearisation, whatever the mesh size") {
  // Oracle: projected_spring_stiffness.h. Compressed and stretched springs, odd ends, several
  // chunks.
  auto organ = ball_organ();
  organ.tissue.drag = 3;
  check_agrees(ball_model(GENERATE(0, 1, 2, 3), organ));
}

TEST_CASE("spring product: agrees without virtual nodes, bending springs or damping") {
  // Oracle: projected_spring_stiffness.h.
  auto organ = ball_organ();
  SECTION("no virtual nodes") { organ.springs = {0.1, 0, 0}; }
  SECTION("no bending springs") { organ.springs.bending_ratio = 0; }
  SECTION("no damping") { organ.tissue.damping_ratio = 0; }
  check_agrees(ball_model(2, organ));
}

TEST_CASE("spring product: springs without length give nothing and no NaN") {
  // Oracle: definition: masses are left.
  const auto model = ball_model(1);
  const std::vector<Vec3> positions(model.node_count(), Vec3(0.1, 0.2, 0.3));
  const auto p = directions(model);
  for (const InstructionSet set : available_instruction_sets()) {
    SpringHessianProduct product(model, model.network(), true, nullptr, set);
    product.linearise(positions, kProductStep);
    std::vector<Vec4f> out(p.size());
    apply(product, p, out);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto mass = static_cast<float>((1 + kProductStep * model.drag) * model.masses[i]);
      CHECK((out[i] - mass * p[i]).norm() < 1e-6f * mass);
    }
  }
}

TEST_CASE("spring product: rounded couplings leave the matrix symmetric, and its blocks its own") {
  // Oracle: invariant a·A b = b·A a, to the rounding of float sums; and the blocks by probing one
  // coordinate of one node at a time.
  const auto model = ball_model(2);
  const auto a = directions(model);
  auto b = a;
  std::reverse(b.begin(), b.end());
  std::vector<Vec4f> image_a(a.size()), image_b(a.size());
  for (const InstructionSet set : available_instruction_sets()) {
    SpringHessianProduct product(model, model.network(), true, nullptr, set);
    product.linearise(disturbed_positions(model, 3e-3), kProductStep);
    const double a_a = apply(product, a, image_a), b_b = apply(product, b, image_b);
    CHECK(a_a > 0);
    CHECK(std::abs(dot(a, image_b) - dot(b, image_a)) < 1e-6 * (a_a + b_b));
    for (const std::size_t node : {std::size_t{0}, std::size_t{77}, model.node_count() - 1}) {
      for (int axis = 0; axis < 3; ++axis) {
        std::vector<Vec4f> unit(a.size(), Vec4f::Zero());
        unit[node][axis] = 1;
        apply(product, unit, image_a);
        const Vec3 column = image_a[node].head<3>().cast<double>();
        const Mat3& block = product.diagonal()[node];
        CHECK((column - block.col(axis)).norm() < 3e-6 * block.norm());
      }
    }
  }
}

TEST_CASE("spring product: the same bits for all instruction sets with fused multiply-add") {
  // Oracle: each other.
  const auto sets = available_instruction_sets();
  if (sets.size() < 3) {
    WARN("SKIPPED: this CPU has no two instruction sets with fused multiply-add");
    return;
  }
  const auto model = ball_model(3);
  const auto p = directions(model);
  std::vector<Vec4f> first(p.size()), second(p.size());
  SpringHessianProduct narrow(model, model.network(), true, nullptr, sets[1]),
      wide(model, model.network(), true, nullptr, sets[2]);
  narrow.linearise(disturbed_positions(model, 3e-3), kProductStep);
  wide.linearise(disturbed_positions(model, 3e-3), kProductStep);
  CHECK(apply(narrow, p, first) == apply(wide, p, second));
  CHECK(first == second);
  CHECK(narrow.diagonal() == wide.diagonal());
}

TEST_CASE("spring product: the same bits for any number of threads") {
  // Oracle: itself on one thread.
  const auto model = ball_model(3);
  const auto positions = disturbed_positions(model, 3e-3);
  const auto p = directions(model);
  for (const InstructionSet set : available_instruction_sets()) {
    std::vector<Vec4f> expected(p.size()), found(p.size());
    SpringHessianProduct serial(model, model.network(), true, nullptr, set);
    serial.linearise(positions, kProductStep);
    apply(serial, p, expected);
    for (std::size_t threads = 2; threads <= 3; ++threads) {
      ChunkThreads runner(threads);
      SpringHessianProduct product(model, model.network(), true, &runner, set);
      product.linearise(positions, kProductStep);
      apply(product, p, found);
      CHECK(found == expected);
      CHECK(product.diagonal() == serial.diagonal());
    }
  }
}

TEST_CASE(
    "spring product: of a patch's slices it is the whole one's part, on any number of threads") {
  // Oracle: the product of all nodes, to the bit; its dot product's share of theirs, of float sums.
  const auto model = ball_model(4);
  const auto p = directions(model);
  std::vector<Vec4f> whole(p.size());
  SpringHessianProduct serial(model, model.network(), true);
  serial.linearise(disturbed_positions(model, 3e-3), kProductStep);
  apply(serial, p, whole);
  std::vector<std::uint32_t> nodes, slices;
  for (std::uint32_t i = 0; i < 1000; ++i) nodes.push_back(2 * i);
  serial.find_slices(nodes, slices);
  std::vector<Vec4f> part(p.size(), Vec4f::Zero());
  const double dot_alone = serial.apply(slices, part);
  double share = 0;
  for (std::size_t i = 0; i < 2000; ++i) share += static_cast<double>(p[i].dot(whole[i]));
  CHECK(dot_alone == Approx(share).epsilon(1e-5));
  for (std::size_t i = 0; i < 2000; ++i) REQUIRE(part[i] == whole[i]);
  for (const std::size_t threads : {2u, 3u}) {
    ChunkThreads runner(threads);
    SpringHessianProduct product(model, model.network(), true, &runner);
    product.linearise(disturbed_positions(model, 3e-3), kProductStep);
    for (std::size_t i = 0; i < p.size(); ++i) product.nodes()[i].vector = p[i];
    std::vector<Vec4f> found(p.size(), Vec4f::Zero());
    CHECK(product.apply(slices, found) == dot_alone);
    CHECK(found == part);
    // Linearised there alone: blocks of the same slices.
    const SpringShares shares{.mass = 1, .damping = kProductStep, .stiffness = 1e-4};
    product.linearise(disturbed_positions(model, 3e-3), shares, slices);
    serial.linearise(disturbed_positions(model, 3e-3), shares, slices);
    for (const std::uint32_t i : nodes) REQUIRE(product.diagonal()[i] == serial.diagonal()[i]);
    serial.linearise(disturbed_positions(model, 3e-3), kProductStep);
  }
}

}  // namespace
}  // namespace palpate::deformation
