// A device of mass m and damping b on a virtual wall z ≤ 0 of stiffness K, sampled at T.
//
// Where stability ends: K = (b + B)/(T/2 + t_d), without virtual damping B. T is the time a force
// is held, t_d the further age of what it was computed from. Energy made by a press and release of
// depth D at speed v: K v D (T + 2 t_d).
#include <catch2/catch.hpp>
#include <cmath>
#include <deque>
#include <functional>
#include <iostream>
#include <vector>

#include "haptics/haptic_renderer.h"
#include "tests/haptics/critical_stiffness.h"
#include "tests/haptics/wall_law.h"
#include "tests/times.h"

using namespace palpate;
using namespace palpate::haptics;

namespace {

constexpr double kMass = 0.1;

/// One degree of freedom along z, moved exactly over a tick under a held force.
struct Mass {
  double damping;
  double z = 0, velocity = 0;
  bool held = false;  ///< by a hand, without delay

  void move(double force) {  // m v̇ = f − b v
    const double decay = std::exp(-damping / kMass * kTick), terminal = force / damping;
    z += terminal * kTick + (velocity - terminal) * kMass / damping * (1 - decay);
    velocity = terminal + (velocity - terminal) * decay;
  }
  DeviceSample sample() const {
    DeviceSample result;
    result.pose.position.z() = z;
    result.twist.linear.z() = velocity;
    if (held) result.delay = 0;
    return result;
  }
};

/// What deformation would send for a probe at `z` on a wall of `stiffness`; with
/// `rate_of_change` = stiffness a local law, with 0 a bare force.
LocalLaw wall_at(double z, double stiffness, double rate_of_change) {
  return testing::wall_law(Vec3(0, 0, z), stiffness, rate_of_change);
}

/// How models reach the loop.
struct Link {
  int update_ticks;  ///< between models
  int delay_ticks;   ///< age of a model on arrival
  bool local_model;  ///< else bare forces
};

using ForceLaw = std::function<double(const LocalLaw*, const Mass&, double)>;

struct Motion {
  std::vector<double> path;  ///< z − rest per tick after the kick [m]
  bool left = false;         ///< grew to 15 mm before the time was over
};

struct Wall {
  double stiffness;     ///< [N/m]
  double depth = 0.02;  ///< where the hand holds the device [m]
};

/// A constant push presses the mass to the wall's depth within 1 s; 1 s later it is kicked to
/// 10 mm/s and left alone for 8 s. `force_of` is the law, given each newest model.
Motion motion(const Link& link, const Wall& wall, double damping, const ForceLaw& force_of) {
  constexpr int kPress = 1000, kKick = 2000, kEnd = 10'000;
  const double rest = -wall.depth, stiffness = wall.stiffness;
  Mass mass{damping};
  std::vector<double> z;
  Motion result;
  for (int i = 0; i < kEnd && !result.left; ++i) {
    const double s = std::min(1.0, static_cast<double>(i) / kPress);
    const double pressed_to = s * s * s * (10 - 15 * s + 6 * s * s) * rest;
    if (i == kKick) mass.velocity += 0.01;
    z.push_back(mass.z);
    if (i >= kKick) result.path.push_back(mass.z - rest);
    const int seen = std::max(0, i - link.delay_ticks);
    LocalLaw model =
        wall_at(z[static_cast<std::size_t>(seen)], stiffness, link.local_model ? stiffness : 0);
    model.period = kTick * link.update_ticks;
    const bool update = i % link.update_ticks == 0;
    const double push = stiffness * pressed_to;
    mass.move(push + force_of(update ? &model : nullptr, mass, kTick * i));
    result.left = std::abs(mass.z - pressed_to) > 0.015;
  }
  return result;
}

/// The force law alone, no limits, no passivity control.
auto bare_law() {
  return [solver = LawSolver()](const LocalLaw* model, const Mass& mass, double) mutable {
    if (model) solver.take(*model);
    return solver.evaluate({Vec3(0, 0, mass.z), Quat::Identity()}, 0).wrench.force.z();
  };
}

/// Limits that do not matter, to see the law and the passivity controller alone.
scene::Haptics strong(double damping) {
  scene::Haptics limits;
  limits.max_force = 100;
  limits.max_force_rate = 1e5;
  limits.device_damping = damping;
  return limits;
}

/// The whole chain.
auto rendered(const scene::Haptics& limits, double* worst_energy = nullptr) {
  return [renderer = HapticRenderer(limits, kTick), worst_energy](
             const LocalLaw* model, const Mass& mass, double time) mutable {
    if (model) renderer.update_law(*model, time);
    RenderedForce out;
    renderer.tick(time, mass.sample(), out);
    if (worst_energy) *worst_energy = std::min(*worst_energy, out.passivity_energy);
    return out.force.z();
  };
}

double largest(const std::vector<double>& path, double from, double to) {
  double result = 0;
  for (std::size_t i = static_cast<std::size_t>(from * static_cast<double>(path.size()));
       i < static_cast<std::size_t>(to * static_cast<double>(path.size())); ++i) {
    result = std::max(result, std::abs(path[i]));
  }
  return result;
}

bool grows(const Motion& motion) {
  return motion.left || largest(motion.path, 0.9, 1) > largest(motion.path, 0.3, 0.4);
}

/// At which the bare law's motion grows.
double bare_border(const Link& link, double damping) {
  return critical_stiffness(4000, [&](double stiffness) {
    return grows(motion(link, {stiffness}, damping, bare_law()));
  });
}

}  // namespace

TEST_CASE("closed loop: stability ends where the formula says") {
  // Oracle: analytic, K = b/(T/2 + t_d), exact for slow motions. Tolerance: −2 % for the
  // bisection's 1 % and slow growth near the border; +10 % where ωT is not small, there the
  // simulated loop is stable a little longer than the formula says.
  struct Case {
    const char* what;
    Link link;
    double damping, hold, delay;
  };
  for (const Case& c : {
           Case{"local model, 250 Hz", {4, 4, true}, 0.1, kTick, 0},
           Case{"local model, 250 Hz", {4, 4, true}, 0.2, kTick, 0},
           Case{"local model, 40 Hz", {25, 25, true}, 0.1, kTick, 0},
           Case{"bare force, 250 Hz", {4, 0, false}, 0.5, 4 * kTick, 0},
           Case{"bare force, 40 Hz + one frame", {25, 25, false}, 0.5, 25 * kTick, 25 * kTick},
       }) {
    const double formula = c.damping / (c.hold / 2 + c.delay);
    const double measured = bare_border(c.link, c.damping);
    std::cout << "critical stiffness, " << c.what << ", b = " << c.damping << ": formula "
              << formula << " N/m, simulated " << measured << " N/m\n";
    CHECK(measured > 0.98 * formula);
    CHECK(measured < 1.1 * formula);
  }
}

TEST_CASE("closed loop: the rendered wall comes to rest below the critical stiffness") {
  // Oracle: analytic. At half the critical stiffness b/(T/2), half of b remains: a motion decays
  // within 2m/(b/2) = 2 s; after 7.2 s to exp(−3.6) = 2.7 %. The rate of the models of a linear
  // wall changes nothing. 5 % allows for the onset's hand-over.
  for (const Link& link : {Link{4, 4, true}, Link{25, 25, true}}) {
    const Motion rendered_motion = motion(link, {200}, 0.2, rendered(strong(0.2)));
    REQUIRE_FALSE(rendered_motion.left);
    CHECK(largest(rendered_motion.path, 0.9, 1) < 0.05 * largest(rendered_motion.path, 0, 0.1));
  }
}

TEST_CASE("closed loop: beyond the critical stiffness limits and passivity bound the vibration") {
  // Oracle: invariants. At twice the critical stiffness, held with 2.5 N, the bare law's motion
  // grows without end. Rendered, with the default limits, it must not: the energy given out beyond
  // what came in stays under the bound of the debt, and the motion within two press depths. (It
  // does vibrate: stored energy pays for it. Only a softer contact or more damping prevents that.)
  const Link link{4, 4, true};
  const scene::Haptics limits;
  const Wall wall{.stiffness = 2 * limits.device_damping / (kTick / 2), .depth = 2.5 / 800};
  REQUIRE(motion(link, wall, limits.device_damping, bare_law()).left);
  double worst_energy = 0;
  const Motion held = motion(link, wall, limits.device_damping, rendered(limits, &worst_energy));
  REQUIRE_FALSE(held.left);
  std::cout << "at " << wall.stiffness << " N/m, twice the critical: vibrates by "
            << largest(held.path, 0.5, 1) * 1e3 << " mm, largest debt " << -worst_energy * 1e3
            << " mJ\n";
  CHECK(largest(held.path, 0, 1) < 2 * wall.depth);
  CHECK(worst_energy > -PassivityControl::kMaxDebt);
}

namespace {

/// How far a push swings on a wall whose laws come every `law_ticks`: peak to peak, in the ticks
/// after `from` until `to` [m]. Begins at the skin.
double swing_of_push(Mass mass, double push, double stiffness, int law_ticks, int from, int to) {
  HapticRenderer renderer(scene::Haptics{}, kTick);
  double least = 1, most = -1;
  for (int i = 0; i < to; ++i) {
    LocalLaw law = wall_at(mass.z, stiffness, stiffness);
    law.period = law_ticks * kTick;
    if (i % law_ticks == 0) renderer.update_law(law, kTick * i);
    RenderedForce out;
    renderer.tick(kTick * i, mass.sample(), out);
    mass.move(out.force.z() - push);
    if (i < from) continue;
    least = std::min(least, mass.z);
    most = std::max(most, mass.z);
  }
  return most - least;
}

}  // namespace

TEST_CASE("closed loop: a held device comes to rest on soft tissue") {
  // Oracle: analytic. Pushed by 0.16 N from rest at the skin of 8 N/m it comes to rest 20 mm deep.
  // Not held it swings by 20 mm exp(−t b/2m) to either side: after 2 s 2.7 mm, of which half at
  // least must be there. Held, damping that is 0.3 of the force makes the spring stiffer by that on
  // the way in and softer on the way out: it turns at 2/1.3 of the depth, then between 1/1.3 and
  // 1/0.7, where either way stops. So after one period at most what is left is damped as
  // exp(−t (b + B)/2m), B = 1 N·s/m. 10 % for the hand-over and the tick.
  for (const bool held : {true, false}) {
    Mass mass{0.2};
    mass.held = held;
    const double swing = swing_of_push(mass, 0.16, 8, 4, 2000, 3000);
    const double begins = held ? 2 * M_PI * std::sqrt(kMass / 8) : 0;
    const double rate = (held ? 1.2 : 0.2) / (2 * kMass);
    CHECK(swing < 1.1 * 2 * 0.02 * std::exp(-(2 - begins) * rate));
    if (!held) CHECK(swing > 0.5 * 2 * 0.02 * std::exp(-2 * rate));
  }
}

TEST_CASE("closed loop: on a wall ten times too stiff a push comes to rest, its laws 10 ms apart") {
  // Oracle: analytic. b 0.2 and T 1 ms hold 400 N/m; undamped on that, a push of 0.5 N swings by
  // twice 0.5 N/400 N/m = 2.5 mm. Without contact damping 4.5 mm for ever.
  Mass mass{0.2};
  mass.held = true;
  const double swing = swing_of_push(mass, 0.5, 4000, 10, 7000, 8000);
  std::cout << "on 4000 N/m, laws at 100 Hz: swings by " << swing * 1e3 << " mm\n";
  CHECK(swing < 2 * 0.5 / 400);
}

namespace {

/// Energy the hand gets back beyond what it gave, in a press and release of depth D at speed v.
double generated(const Link& link, double stiffness, double speed, double depth,
                 const ForceLaw& force_of) {
  const int half = static_cast<int>(std::lround(depth / speed / kTick));
  const auto z_at = [&](int i) {
    return -speed * kTick * (i <= half ? std::max(0, i) : std::max(2 * half - i, -half));
  };
  double energy = 0;
  for (int i = -100; i < 3 * half; ++i) {
    LocalLaw model =
        wall_at(z_at(i - link.delay_ticks), stiffness, link.local_model ? stiffness : 0);
    model.period = kTick * link.update_ticks;
    const bool update = (i + 100) % link.update_ticks == 0;
    const Mass mass{1, z_at(i), (z_at(i + 1) - z_at(i)) / kTick};
    const double force = force_of(update ? &model : nullptr, mass, kTick * (i + 100));
    energy += force * (z_at(i + 1) - z_at(i));
  }
  return energy;
}

}  // namespace

TEST_CASE("closed loop: a press and release leaks what the formula says, and not when controlled") {
  // Oracle: analytic, K v D (T + 2 t_d), K 200 N/m, v 40 mm/s, D 10 mm. Where the force is held
  // for 25 ms, turning points fall anywhere within a hold: 15 %. Controlled, the device's own loss
  // 2 b v D is the most that may be generated; 5 % for a tick's power.
  const double stiffness = 200, speed = 0.04, depth = 0.01, damping = 0.05;
  const double stored = 0.5 * stiffness * depth * depth;
  struct Case {
    const char* what;
    Link link;
    double hold, delay, tolerance;
  };
  for (const Case& c : {
           Case{"local model, 250 Hz", {4, 4, true}, kTick, 0, 0.05},
           Case{"bare force, 250 Hz", {4, 0, false}, 4 * kTick, 0, 0.05},
           Case{"bare force, 40 Hz + one frame", {25, 25, false}, 25 * kTick, 25 * kTick, 0.15},
       }) {
    const double formula = stiffness * speed * depth * (c.hold + 2 * c.delay);
    const double bare = generated(c.link, stiffness, speed, depth, bare_law());
    const double controlled = generated(c.link, stiffness, speed, depth, rendered(strong(damping)));
    std::cout << "press and release, " << c.what << ": formula " << formula * 1e3 << " mJ ("
              << 100 * formula / stored << " % of the stored), bare law " << bare * 1e3
              << " mJ, rendered " << controlled * 1e3 << " mJ\n";
    CHECK(bare > formula * (1 - c.tolerance));
    CHECK(bare < formula * (1 + c.tolerance));
    CHECK(controlled <= 2 * damping * speed * depth * 1.05);
    CHECK(controlled <= bare);
  }
}
