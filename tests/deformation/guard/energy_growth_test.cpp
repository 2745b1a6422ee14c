#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "deformation/guard/divergence_detector.h"
#include "tests/deformation/guard/torn_organ.h"
#include "tests/deformation/volume/rules/method_checks.h"

namespace palpate::deformation {
namespace {

constexpr double kGrowthPeriod = 5e-4;  // [s]
constexpr double kLongGrowth = 1;       // in which a node may come as far as the tests put it [s]

TEST_CASE("divergence detector: falling is not gaining, nor is what the fall gives") {
  // Oracle: m g s for what moves about the mean as the ball lands; without gravity it is too much.
  const auto organ = testing::undamped_ball_with("implicit_volume");
  for (const double g : {9.81, 0.0}) {
    const auto model = testing::ball_model(1, organ, Vec3(0, 0, -g));
    auto dynamics = testing::constrained(model);
    DivergenceDetector detector(model, true);
    OrganState state = rest_state(model);
    detector.begin(state, 0);
    for (int s = 1; s <= 1000; ++s) {
      for (auto& v : state.velocities) v.z() = -9.81 * s * kGrowthPeriod;
      for (auto& p : state.positions) p.z() -= 9.81 * s * kGrowthPeriod * kGrowthPeriod;
      REQUIRE((s % 10 == 0 ? detector.check_thoroughly(state, kGrowthPeriod, dynamics)
                           : detector.check(state, kGrowthPeriod, dynamics)) == Violation::kNone);
    }
    CHECK_FALSE(detector.suspicious());
    if (g == 0) detector.begin(rest_state(model), 0);
    testing::tear(model, 9.81 * 0.5 / std::sqrt(testing::moving_share(model)), state);
    CHECK(detector.check(state, kLongGrowth, dynamics) ==
          (g > 0 ? Violation::kNone : Violation::kEnergyGrew));
  }
}

TEST_CASE(
    "divergence detector: elastic energy that nobody gave is suspicious, what it does as it comes "
    "free is too much") {
  // Oracle: definitions; a ball swollen by a third holds a hundred times what it may, at rest. What
  // it does with a tenth of that and more is judged.
  auto organ = testing::undamped_ball_with("mass_spring");
  organ.tissue.youngs_modulus *= 1000;
  const auto model = testing::ball_model(2, organ);
  auto dynamics = testing::constrained(model);
  DivergenceDetector detector(model, true);
  OrganState state = rest_state(model);
  detector.begin(state, 0);
  for (Vec3& p : state.positions) p *= 4.0 / 3;
  double mass = 0;
  for (const double m : model.masses) mass += m;
  const double stored = dynamics.elastic_energy(state);
  REQUIRE(stored > 10 * kEnergyGain * mass * kCalmSpeed * kCalmSpeed / 2);
  CHECK(detector.check_thoroughly(state, kLongGrowth, dynamics) == Violation::kNone);
  CHECK(detector.suspicious());
  CHECK(detector.energy_budget() == 0);  // it is not given to it
  const double moving = testing::moving_share(model) * mass;
  const double speed_of_tenth = std::sqrt(2 * stored / (9 * moving));
  REQUIRE(speed_of_tenth > kShakenSpeed);
  for (const double share : {0.9, 1.1}) {
    DivergenceDetector judge(model, true);
    judge.begin(rest_state(model), 0);
    CHECK(judge.check(state, kLongGrowth, dynamics) == Violation::kNone);
    OrganState free = state;
    testing::tear(model, share * speed_of_tenth, free);
    CHECK(judge.check(free, kLongGrowth, dynamics) ==
          (share > 1 ? Violation::kEnergyGrew : Violation::kNone));
  }
}

TEST_CASE("divergence detector: what throws an organ as a whole is no instability of it") {
  // Oracle: nothing inner moves the centre of mass; the same energy about it is too much.
  const auto model = testing::ball_model(2);
  auto dynamics = testing::constrained(model);
  for (const bool inner : {false, true}) {
    DivergenceDetector detector(model, true);
    OrganState state = rest_state(model);
    detector.begin(state, 0);
    const double speed = 4 * kShakenSpeed;
    if (inner) testing::tear(model, speed, state);
    if (!inner) std::ranges::fill(state.velocities, Vec3(speed, 0, 0));
    CHECK(detector.check(state, kLongGrowth, dynamics) ==
          (inner ? Violation::kEnergyGrew : Violation::kNone));
    CHECK(detector.suspicious() == inner);
  }
}

TEST_CASE("divergence detector: energy has to grow, at once tenfold or from check to check") {
  // Oracle: definition. A motion that nobody gave is known when it comes from calm; one that only
  // loses is tissue come free, one that gains while it is fast is not.
  const auto organ = testing::undamped_ball_with("mass_spring");
  const auto model = testing::ball_model(2, organ);
  auto dynamics = testing::constrained(model);
  const auto last_of = [&](std::initializer_list<double> speeds) {
    DivergenceDetector detector(model, true);
    OrganState state = rest_state(model);
    detector.begin(state, 0);
    Violation seen = Violation::kNone;
    for (const double speed : speeds) {
      testing::tear(model, speed, state);
      seen = detector.check(state, kLongGrowth, dynamics);
    }
    return seen;
  };
  const double slow = 0.75 * kShakenSpeed, fast = 1.5 * kShakenSpeed;
  CHECK(last_of({fast}) == Violation::kEnergyGrew);
  CHECK(last_of({slow}) == Violation::kNone);
  CHECK(last_of({slow, fast}) == Violation::kNone);
  CHECK(last_of({slow, fast, 0.99 * fast}) == Violation::kNone);
  CHECK(last_of({slow, fast, 1.01 * fast}) == Violation::kEnergyGrew);
  CHECK(last_of({slow, 4 * fast}) == Violation::kEnergyGrew);
}

/// Stores what the test says.
class StoredByHand : public OrganDynamics {
 public:
  double stored = 0;  ///< [J]
  double largest_step() const override { return 1; }
  StepReport step(double, std::span<ContactRow>, OrganState&) override { return {}; }
  double elastic_energy(const OrganState&) override { return stored; }
};

TEST_CASE("divergence detector: motion is not paid for by energy below nothing") {
  // Oracle: the fast halves gain a tenth of their speed, which nobody gave. Stored energy that
  // falls by as much pays for it; below 0 there is none to pay with.
  const auto model = testing::ball_model(2);
  double mass = 0;
  for (const double m : model.masses) mass += m;
  const double slow = 0.75 * kShakenSpeed, fast = 1.5 * kShakenSpeed;
  const double much = mass * fast * fast;  // more than all motion here [J]
  for (const double from : {much, 0.0}) {
    DivergenceDetector detector(model, true);
    StoredByHand dynamics;
    OrganState state = rest_state(model);
    detector.begin(state, 0);
    Violation seen = Violation::kNone;
    dynamics.stored = from;
    for (const double speed : {slow, fast, 1.1 * fast}) {
      testing::tear(model, speed, state);
      seen = detector.check(state, kLongGrowth, dynamics);
      if (speed >= fast) dynamics.stored = from - much;
    }
    CHECK(seen == (from > 0 ? Violation::kNone : Violation::kEnergyGrew));
  }
}

/// A row on a node that flies towards +x, whose impulse does this work on it at that velocity.
ContactRow working_row(const Body& body, const OrganState& state, double work) {
  ContactRow row;
  std::uint32_t node = 0;
  while (body.rest_positions[node].x() <= 0) ++node;
  row.nodes = {node, node, node};
  row.weights = Vec3(1, 0, 0);
  row.normal = -state.velocities[node].normalized();
  row.normal_impulse = work / state.velocities[node].norm();
  return row;
}

TEST_CASE("divergence detector: a probe that drives tissue on pays for what it gains") {
  // Oracle: work and energy. Halves that fly apart gain 2 % of their energy: no more than a probe
  // that moves with them gives, more than it gives, or given by a probe at rest, which does no
  // work.
  const auto model = testing::ball_model(2);
  const double slow = 0.75 * kShakenSpeed, fast = 1.5 * kShakenSpeed;
  double moving = 0;
  for (const double m : model.masses) moving += m;
  moving *= testing::moving_share(model);
  const double gain = moving * fast * fast * (1.01 * 1.01 - 1) / 2;
  const auto judged = [&](double work, bool drives) {
    DivergenceDetector detector(model, true);
    StoredByHand dynamics;
    OrganState state = rest_state(model);
    detector.begin(state, 0);
    for (const double speed : {slow, fast}) {
      testing::tear(model, speed, state);
      REQUIRE(detector.check(state, kLongGrowth, dynamics) == Violation::kNone);
    }
    testing::tear(model, 1.01 * fast, state);
    ContactRow row = working_row(model, state, work);
    if (drives) row.probe_velocity = state.velocities[row.nodes[0]];
    detector.add_work(kGrowthPeriod, std::span(&row, 1), 0, state);
    return detector.check(state, kLongGrowth, dynamics);
  };
  CHECK(judged(1.1 * gain, true) == Violation::kNone);
  CHECK(judged(0.9 * gain, true) == Violation::kEnergyGrew);
  CHECK(judged(1.1 * gain, false) == Violation::kEnergyGrew);
}

TEST_CASE("divergence detector: at a first look crushed tissue has not grown, at the next it can") {
  // Oracle: definition. More than one push is injected into halves that fly apart; a tenth of what
  // is stored and moves has to be motion. Of what holds more, the next look knows the growth.
  const auto model = testing::ball_model(2);
  const double fast = 1.5 * kShakenSpeed;
  double mass = 0;
  for (const double m : model.masses) mass += m;
  const double motion = mass * testing::moving_share(model) * fast * fast / 2;
  for (const double stored : {8 * motion, 10 * motion}) {
    DivergenceDetector detector(model, true);
    StoredByHand dynamics;
    OrganState state = rest_state(model);
    detector.begin(state, motion);
    dynamics.stored = stored;
    const auto look = [&](double speed) {
      testing::tear(model, speed, state);
      for (std::size_t i = 0; i < model.node_count(); ++i) {
        state.positions[i] += kGrowthPeriod * state.velocities[i];
      }
      ContactRow row =
          working_row(model, state, 1.1 * mass * kMaxSeparationSpeed * kMaxSeparationSpeed);
      detector.add_work(kGrowthPeriod, std::span(&row, 1), 0, state);
      return detector.check(state, kGrowthPeriod, dynamics);
    };
    const bool crushed = stored > 9 * motion;
    CHECK(look(fast) == (crushed ? Violation::kNone : Violation::kEnergyGrew));
    if (crushed) CHECK(look(1.01 * fast) == Violation::kEnergyGrew);
  }
}

TEST_CASE("divergence detector: an organ in motion is looked at closely") {
  // Oracle: definition. A mirrored ball encloses −V₀; at rest that is left to the next thorough
  // check.
  const auto model = testing::ball_model(2);
  auto dynamics = testing::constrained(model);
  for (const bool in_motion : {false, true}) {
    DivergenceDetector detector(model, true);
    OrganState state = rest_state(model);
    detector.begin(state, 0);
    for (Vec3& p : state.positions) p.x() = -p.x();
    if (in_motion) testing::tear(model, 1.5 * kMaxSeparationSpeed, state);
    CHECK(detector.check(state, kLongGrowth, dynamics) ==
          (in_motion ? Violation::kTurnedInside : Violation::kNone));
  }
}

}  // namespace
}  // namespace palpate::deformation
