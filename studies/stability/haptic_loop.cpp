#include "studies/stability/haptic_loop.h"

#include <algorithm>
#include <cmath>

#include "haptics/devices/placed_device.h"
#include "haptics/local_law.h"
#include "modules/bus/tap.h"
#include "modules/core/error.h"
#include "palpate/session/in_process.h"
#include "studies/rigs/wall_stage.h"

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

/// In the place of haptics: the newest law at the device's pose, and nothing else.
class BareLawStage final : public runtime::Stage {
 public:
  BareLawStage(bus::Bus& bus, haptics::Device& device)
      : laws_(bus.reader(bus::kContactModel)),
        states_(bus.writer(bus::kProbeState)),
        forces_(bus.writer(bus::kHapticForce)),
        device_(device) {}

  runtime::Health cycle(const runtime::Cycle& now) override {
    while (laws_.take(law_)) solver_.take(law_);
    state_.header = force_.header = now.header();
    state_.pose = device_.read(now.time()).pose;
    force_.force = solver_.evaluate(state_.pose, 0).wrench.force;
    states_.write(state_);
    forces_.write(force_);
    return {};
  }

 private:
  bus::Reader<ContactModel> laws_;
  bus::Writer<ProbeState> states_;
  bus::Writer<HapticForce> forces_;
  haptics::Device& device_;
  haptics::LawSolver solver_;
  ContactModel law_;
  ProbeState state_;
  HapticForce force_;
};

scene::Scene scene_of(const Loop& loop) {
  scene::Scene scene;
  scene.probes.push_back({"device", scene::SphereShape{}, 0, scene::ScriptedDevice{}});
  scene.haptics.device_damping = kHandDamping;
  scene.rates.haptics = scene.rates.deformation = loop.rate;
  return scene;
}

/// Haptics and a wall; contact models are `delay` periods old when haptics uses them.
class LoopSession {
 public:
  LoopSession(const Loop& loop, int delay, double stiffness)
      : session_(scene_of(loop), {{}, {geometry::TriangleSurface{}}},
                 options(loop, delay, stiffness)) {
    if (!loop.passivity) return;
    auto device = std::make_unique<haptics::PlacedDevice>(Pose{});
    device_ = device.get();
    session_.haptics().set_device(0, std::move(device));
  }

  /// The force on the hand until the next tick [N].
  double tick(const Hand& hand) {
    Pose pose;
    pose.position.z() = hand.z;
    device_->place(pose, {hand.velocity * Vec3::UnitZ(), Vec3::Zero()});
    session_.tick();
    return session_.haptic_force(0).force.z();
  }

 private:
  session::InProcessOptions options(const Loop& loop, int delay, double stiffness) {
    session::InProcessOptions options;
    options.tap = [delay](bus::Bus& carrier) {
      auto tapped = std::make_unique<bus::TappedBus>(carrier);
      tapped->set_tap(bus::kContactModel.name, bus::delay_tap(static_cast<std::size_t>(delay - 1)));
      return tapped;
    };
    options.make = [=, this](std::string_view module, bus::Bus& bus,
                             const session::MakeStage& usual) -> std::unique_ptr<runtime::Stage> {
      if (module == "collision") return nullptr;
      if (module == "deformation") {
        return std::make_unique<rigs::WallStage>(bus, stiffness, loop.local_model);
      }
      if (loop.passivity) return usual(bus);
      return std::make_unique<BareLawStage>(bus, *device_);
    };
    return options;
  }

  haptics::PlacedDevice bare_device_{Pose{}};
  haptics::PlacedDevice* device_ = &bare_device_;
  session::InProcess session_;
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
  PALPATE_DEMAND(delay_ticks >= 1);
  const int end = static_cast<int>(kEnd * loop.rate), kick = static_cast<int>(kKick * loop.rate);
  LoopSession session(loop, delay_ticks, stiffness);
  Hand hand;
  std::vector<double> path;
  bool left = false;
  for (int i = 0; i < end && !left; ++i) {
    if (i % 1000 == 0) keep_going();
    const double s = std::min(1.0, i * tick / kPress);
    const double pressed_to = -depth * s * s * s * (10 - 15 * s + 6 * s * s);
    if (i == kick) hand.velocity += kKickSpeed;
    if (i >= kick) path.push_back(hand.z + depth);
    hand.move(stiffness * pressed_to + session.tick(hand), tick);
    left = std::abs(hand.z - pressed_to) > kLeft;
  }
  return verdict_of(path, left);
}

double critical_stiffness(const Loop& loop, double delay) {
  return kHandDamping / (0.5 / loop.rate + (loop.local_model ? 0 : delay));
}

}  // namespace palpate::stability
