#include "studies/stability/haptic_loop.h"

#include <algorithm>
#include <cmath>

#include "haptics/haptic_renderer.h"

namespace palpate::stability {
namespace {

constexpr double kPress = 1, kKick = 2, kEnd = 20;  // [s]
constexpr double kKickSpeed = 0.01;                 // [m/s]
constexpr double kPush = 2.5, kDeepest = 0.02;      // [N], [m]
constexpr double kLeft = 0.015;                     // [m]
constexpr double kRest = 1e-6;                      // no hand feels and no device resolves it [m]
constexpr double kDecay = 0.9;  // a vibration that is only bounded stays as large as it is

/// One degree of freedom along z, moved exactly over a tick under a held force.
struct Hand {
  double z = 0, velocity = 0;

  void move(double force, double tick) {  // m v̇ = f − b v
    constexpr double kTime = kHandMass / kHandDamping;
    const double decay = std::exp(-tick / kTime), terminal = force / kHandDamping;
    z += terminal * tick + (velocity - terminal) * kTime * (1 - decay);
    velocity = terminal + (velocity - terminal) * decay;
  }
};

/// What deformation sends for a probe at `z` on a wall z ≤ 0.
LocalLaw wall_at(double z, double stiffness, bool local_model) {
  LocalLaw model;
  model.touching = z < 0;
  model.anchor.z() = z;
  model.force.z() = std::max(0.0, -stiffness * z);
  model.stiffness(2, 2) = local_model ? stiffness : 0;
  model.validity_radius = 0.05;
  return model;
}

class ForceLaw {
 public:
  explicit ForceLaw(const Loop& loop)
      : passivity_(loop.passivity), renderer_(limits(), 1 / loop.rate) {}

  double force(const LocalLaw& model, const Hand& hand, double time) {
    if (!passivity_) return haptics::evaluate(model, Vec3(0, 0, hand.z)).wrench.force.z();
    renderer_.update_law(model, time);
    haptics::DeviceSample sample;
    sample.pose.position.z() = hand.z;
    sample.twist.linear.z() = hand.velocity;
    RenderedForce out;
    renderer_.tick(time, sample, out);
    return out.force.z();
  }

 private:
  static scene::Haptics limits() {
    scene::Haptics limits;
    limits.device_damping = kHandDamping;
    return limits;
  }

  bool passivity_;
  haptics::HapticRenderer renderer_;
};

double largest(const std::vector<double>& path, double from, double to) {
  const auto at = [&](double share) {
    return path.begin() + static_cast<long>(share * static_cast<double>(path.size()));
  };
  double result = 0;
  for (auto z = at(from); z < at(to); ++z) result = std::max(result, std::abs(*z));
  return result;
}

Verdict verdict_of(const std::vector<double>& path, bool left) {
  Verdict verdict;
  verdict.displacement = largest(path, 0, 1) / kLeft;
  const double early = largest(path, 0.3, 0.4), late = largest(path, 0.9, 1);
  verdict.energy = early > 0 ? late * late / (early * early) : 0;  // of the spring
  if (left) {
    verdict.state = State::kDiverged;
  } else if (late > kRest && late > kDecay * early) {
    verdict.state = State::kOscillating;
  }
  return verdict;
}

}  // namespace

Verdict close_loop(const Loop& loop, double delay, double stiffness, const KeepGoing& keep_going) {
  const double tick = 1 / loop.rate, depth = std::min(kDeepest, kPush / stiffness);
  const int delay_ticks = static_cast<int>(std::lround(delay * loop.rate));
  const int end = static_cast<int>(kEnd * loop.rate), kick = static_cast<int>(kKick * loop.rate);
  ForceLaw law(loop);
  Hand hand;
  std::vector<double> z, path;
  bool left = false;
  for (int i = 0; i < end && !left; ++i) {
    if (i % 1000 == 0) keep_going();
    const double s = std::min(1.0, i * tick / kPress);
    const double pressed_to = -depth * s * s * s * (10 - 15 * s + 6 * s * s);
    if (i == kick) hand.velocity += kKickSpeed;
    z.push_back(hand.z);
    if (i >= kick) path.push_back(hand.z + depth);
    const double seen = z[static_cast<std::size_t>(std::max(0, i - delay_ticks))];
    const double force = law.force(wall_at(seen, stiffness, loop.local_model), hand, i * tick);
    hand.move(stiffness * pressed_to + force, tick);
    left = std::abs(hand.z - pressed_to) > kLeft;
  }
  return verdict_of(path, left);
}

double critical_stiffness(const Loop& loop, double delay) {
  return kHandDamping / (0.5 / loop.rate + (loop.local_model ? 0 : delay));
}

}  // namespace palpate::stability
