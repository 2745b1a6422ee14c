#include "deformation/spring_product.h"

#include <catch2/catch.hpp>
#include <random>
#include <thread>

#include "deformation/spring_linearization.h"
#include "organs.h"

namespace palpate::deformation {
namespace {

using testing::ball_model;
using testing::ball_organ;

constexpr double kStep = 5e-3;  // [s]

std::vector<Vec3> disturbed(const OrganModel& model, double amplitude) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto positions = model.network.rest_positions;
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

void check_agrees(const OrganModel& model) {
  const auto positions = disturbed(model, 3e-3);
  const auto p = directions(model);
  SpringLinearization plain(model);
  plain.linearise(positions, kStep);
  std::vector<Vec4f> expected(p.size()), found(p.size());
  plain.apply(p, expected);
  for (const InstructionSet set : available_instruction_sets()) {
    INFO(name_of(set));
    SpringProduct fast(model, nullptr, set);
    fast.linearise(positions, kStep);
    fast.apply(p, found);
    for (std::size_t i = 0; i < p.size(); ++i) {
      // Floats: each of a node's terms is off by some 6e-8 of the node's block; an inner node's
      // sums have hundreds of terms.
      const double size = plain.diagonal()[i].norm();
      CHECK((found[i] - expected[i]).norm() < 3e-6 * size);
      CHECK((fast.diagonal()[i] - plain.diagonal()[i]).norm() < 3e-6 * size);
    }
  }
}

TEST_CASE("spring product: agrees with the plain linearisation, whatever the mesh size") {
  // Oracle: spring_linearization.h. Compressed and stretched springs, odd ends, several chunks.
  auto organ = ball_organ();
  organ.tissue.drag = 3;
  check_agrees(ball_model(GENERATE(0, 1, 2, 3), organ));
}

TEST_CASE("spring product: agrees without virtual nodes, bending springs or damping") {
  // Oracle: spring_linearization.h.
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
    SpringProduct product(model, nullptr, set);
    product.linearise(positions, kStep);
    std::vector<Vec4f> out(p.size());
    product.apply(p, out);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto mass = static_cast<float>((1 + kStep * model.drag) * model.masses[i]);
      CHECK((out[i] - mass * p[i]).norm() < 1e-6f * mass);
    }
  }
}

class Threads : public ChunkRunner {
 public:
  explicit Threads(std::size_t count) : count_(count) {}
  void run(std::size_t chunks, ChunkBody body) override {
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < count_; ++t) {
      threads.emplace_back([=, this] {
        for (std::size_t chunk = t; chunk < chunks; chunk += count_) body(chunk);
      });
    }
    for (auto& thread : threads) thread.join();
  }

 private:
  std::size_t count_;
};

TEST_CASE("spring product: the same bits for any number of threads") {
  // Oracle: itself on one thread.
  const auto model = ball_model(3);
  const auto positions = disturbed(model, 3e-3);
  const auto p = directions(model);
  for (const InstructionSet set : available_instruction_sets()) {
    std::vector<Vec4f> expected(p.size()), found(p.size());
    SpringProduct serial(model, nullptr, set);
    serial.linearise(positions, kStep);
    serial.apply(p, expected);
    for (std::size_t threads = 2; threads <= 3; ++threads) {
      Threads runner(threads);
      SpringProduct product(model, &runner, set);
      product.linearise(positions, kStep);
      product.apply(p, found);
      CHECK(found == expected);
      CHECK(product.diagonal() == serial.diagonal());
    }
  }
}

}  // namespace
}  // namespace palpate::deformation
