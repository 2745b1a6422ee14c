#include "deformation/organ_contacts.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <ctime>
#include <limits>
#include <random>

#include "deformation/models.h"
#include "modules/scene/models.h"
#include "tests/deformation/touching_organs.h"

namespace palpate::deformation {
namespace {

using testing::any_triangles_cross;
using testing::ball_at;
using testing::ball_organ;
using testing::kBallRadius;
using testing::kPeriod;

/// Without damping by the surroundings; stepped by symplectic Euler.
scene::Organ loose_ball(const char* model = "implicit_volume") {
  scene::Organ organ = ball_organ();
  organ.model = model;
  organ.tissue.drag = 0;
  if (scene::format_of(model).has_integrator)
    organ.integrator = scene::Integrator::kSymplecticEuler;
  return organ;
}

/// Two balls whose facing poles are `gap` apart along x, stepped together.
struct TwoBalls {
  scene::Scene scene;
  std::vector<std::unique_ptr<SimulatedOrgan>> organs;
  std::unique_ptr<OrganContacts> contacts;
  AdvanceReport report;
  double h = 0, time = 0;

  explicit TwoBalls(const scene::Organ& organ = loose_ball(), int levels = 2, double gap = 1e-3) {
    scene.contacts = {true, true, 0.1};
    const double shift = kBallRadius + gap / 2;
    for (const double side : {-1.0, 1.0}) {
      scene.organs.push_back(organ);
      scene.organs.back().name = side < 0 ? "left" : "right";
      auto model = std::make_unique<const OrganModel>(build_organ_model(
          organ, Vec3::Zero(), ball_at(Vec3(side * shift, 0.1 * side * kBallRadius, 0), levels)));
      auto dynamics = make_dynamics(organ, *model, kPeriod);
      organs.push_back(
          std::make_unique<SimulatedOrgan>(organ, std::move(model), std::move(dynamics)));
    }
    contacts = std::make_unique<OrganContacts>(
        scene, std::vector<SimulatedOrgan*>{organs[0].get(), organs[1].get()});
    h = kPeriod / std::max(organs[0]->substeps(kPeriod), organs[1]->substeps(kPeriod));
  }

  /// At each other, and both along y.
  void fling(double speed, double together = 0) {
    for (std::size_t i = 0; i < 2; ++i) {
      OrganState state = rest_state(organs[i]->model());
      for (Vec3& v : state.velocities) v = Vec3((i == 0 ? 1 : -1) * speed, together, 0);
      organs[i]->put(state);
    }
  }

  void step() {
    contacts->begin_step();
    time += h;
    for (auto& organ : organs) organ->step(time, h, {}, report);
    contacts->end_step(h, {}, report);
  }

  struct Sums {
    Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
    double energy = 0, mass = 0;
  };
  Sums sums() const {
    Sums sums;
    for (const auto& organ : organs) {
      const OrganState& state = organ->state();
      for (std::size_t i = 0; i < state.positions.size(); ++i) {
        const Vec3 p = organ->model().masses[i] * state.velocities[i];
        sums.momentum += p;
        sums.angular += state.positions[i].cross(p);
        sums.mass += organ->model().masses[i];
      }
      sums.energy += kinetic_energy(organ->model(), state.velocities) +
                     organ->dynamics().elastic_energy(state);
    }
    return sums;
  }

  bool crosses() const {
    return any_triangles_cross({{organs[0]->state().positions, &organs[0]->model()},
                                {organs[1]->state().positions, &organs[1]->model()}});
  }
};

TEST_CASE("organ contacts: two organs flung at each other keep momentum and never gain energy") {
  // Oracle: Newton's third law; dissipation. 1e-6: springs in float keep it to 1e-7 of the impulses
  // of a step (docs/decisions/0005). Angular momentum: friction acts at places kRestGap apart.
  for (const double speed : {0.1, 0.5}) {
    TwoBalls balls;
    balls.fling(speed);
    const auto before = balls.sums();
    const double scale = before.mass * speed;
    double most = 0;
    std::size_t touches = 0;
    while (balls.time < 0.4) {
      balls.step();
      most = std::max(most, balls.sums().energy);
      touches = std::max(touches, balls.contacts->count(0));
    }
    const auto after = balls.sums();
    INFO("speed " << speed << ", momentum " << (after.momentum - before.momentum).norm() / scale
                  << ", angular " << (after.angular - before.angular).norm() / scale / kBallRadius
                  << ", energy " << most / before.energy << " then " << after.energy / before.energy
                  << ", contacts " << touches);
    CHECK(touches > 3);
    CHECK((after.momentum - before.momentum).norm() < 1e-6 * scale);
    CHECK((after.angular - before.angular).norm() <
          scale * OrganContacts::kRestGap + 1e-6 * scale * kBallRadius);
    CHECK(most <= before.energy * (1 + 1e-6));
    CHECK(after.energy < 0.9 * before.energy);
    CHECK(after.momentum.norm() < 1e-6 * scale);
    CHECK_FALSE(balls.report.organ_motion_cut);
  }
}

/// Of the processor, for steps of two balls that begin at rest but for what they do together, the
/// least of three.
double least_time(TwoBalls& balls, double together = 0) {
  std::clock_t least = std::numeric_limits<std::clock_t>::max();
  for (int k = 0; k < 3; ++k) {
    balls.fling(0, together);
    const std::clock_t began = std::clock();
    for (int step = 0; step < 20; ++step) balls.step();
    least = std::min(least, std::clock() - began);
  }
  return static_cast<double>(least);
}

TEST_CASE("organ contacts: organs that were in a hurry cost no more once they are still") {
  // Oracle: the same organs at rest, before and after a step at 20 m/s; with all pairs looked at in
  // each it is 58 times.
  TwoBalls balls;
  const double before = least_time(balls);
  balls.fling(-20);
  balls.step();
  const double after = least_time(balls);
  INFO("over before " << after / before);
  CHECK(after < 5 * before);
}

TEST_CASE("organ contacts: organs that fall together cost what they cost at rest") {
  // Oracle: the same organs at rest; by each one's own way it is thousands of times.
  TwoBalls balls;
  const double at_rest = least_time(balls), falling = least_time(balls, 5);
  INFO("over at rest " << falling / at_rest);
  CHECK(falling < 5 * at_rest);
}

TEST_CASE("organ contacts: whatever the speed, organs never pass through each other") {
  // Oracle: brute force over all pairs of triangles, after every step.
  for (const double speed : {0.3, 3.0, 20.0}) {
    TwoBalls balls(loose_ball(), speed > 10 ? 1 : 2);
    balls.fling(speed);
    bool crossed = false;
    for (int k = 0; k < 30; ++k) {
      balls.step();
      crossed |= balls.crosses();
    }
    INFO("speed " << speed);
    CHECK_FALSE(crossed);
  }
}

TEST_CASE("organ contacts: hold for every model that goes with them") {
  // Oracle: brute force; Newton's third law.
  std::size_t models = 0;
  for (const scene::ModelFormat& format : scene::model_formats()) {
    if (!format.takes_organ_contacts) continue;
    INFO(format.word);
    TwoBalls balls(loose_ball(format.word));
    CHECK_FALSE(balls.organs[0]->dynamics().is_implicit());
    balls.fling(0.3);
    const double scale = balls.sums().mass * 0.3;
    std::size_t touches = 0;
    bool crossed = false;
    for (int k = 0; balls.time < 0.15; ++k) {
      balls.step();
      touches = std::max(touches, balls.contacts->count(1));
      if (k % 10 == 0) crossed |= balls.crosses();
    }
    CHECK(touches > 2);
    CHECK_FALSE(crossed);
    CHECK(balls.sums().momentum.norm() < 1e-6 * scale);
    ++models;
  }
  CHECK(models == 9);
}

TEST_CASE("organ contacts: organs that rest on each other stay kRestGap apart and calm") {
  // Oracle: the rest gap; 2 % of it is what kOrganVelocityTolerance leaves open in 40 steps.
  TwoBalls balls;
  balls.fling(0.02);
  double least = 1;
  collision::NearFeatures features(
      {balls.organs[0]->model().triangles, balls.organs[1]->model().triangles}, {true, false});
  while (balls.time < 0.2) {
    balls.step();
    std::vector<std::span<const Vec3>> positions;
    for (const auto& organ : balls.organs) {
      positions.push_back(
          std::span(organ->state().positions).first(organ->model().surface_node_count));
    }
    features.search(positions, 1e-3);
    for (const auto& near : features.pairs()) least = std::min(least, near.distance);
  }
  INFO("least distance " << least);
  CHECK(least > 0.98 * OrganContacts::kRestGap);
  CHECK(least < 1.5 * OrganContacts::kRestGap);
}

TEST_CASE("organ contacts: an organ put onto another is told, and reset forgets") {
  // Oracle: brute force.
  TwoBalls balls;
  CHECK_FALSE(balls.contacts->are_crossed());
  OrganState state = rest_state(balls.organs[0]->model());
  for (Vec3& x : state.positions) x.x() += 0.03;
  balls.organs[0]->put(state);
  CHECK(balls.contacts->are_crossed());
  CHECK(balls.crosses());
  balls.fling(0.1);
  CHECK_FALSE(balls.contacts->are_crossed());
  balls.contacts->reset();
  CHECK(balls.contacts->count(0) == 0);
}

}  // namespace
}  // namespace palpate::deformation
