// Deformation or collision begin anew under a pressed probe.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "haptics/devices/placed_device.h"
#include "modules/bus/tap.h"
#include "modules/core/data_folder.h"
#include "modules/scene/scene_reader.h"
#include "palpate/session/in_process.h"
#include "studies/rigs/poked_organ.h"

namespace palpate::contact_loop {
namespace {

constexpr double kRestart = 1.0;  // [s]
constexpr double kBack = 1.0;     // within which the force is to be back [s]

/// Silent for a while from kRestart on, then as if started anew.
class Restarted final : public runtime::Stage {
 public:
  Restarted(std::unique_ptr<runtime::Stage> stage, double silence)
      : stage_(std::move(stage)), silence_(silence) {}

  runtime::Health cycle(const runtime::Cycle& now) override {
    if (now.time() < kRestart || restarted_) return stage_->cycle(now);
    if (now.time() < kRestart + silence_) return {};
    restarted_ = true;
    runtime::Cycle anew = now;
    anew.reset = true;
    return stage_->cycle(anew);
  }

 private:
  std::unique_ptr<runtime::Stage> stage_;
  double silence_;
  bool restarted_ = false;
};

std::unique_ptr<bus::Bus> losing(bus::Bus& carrier, double loss) {
  auto tapped = std::make_unique<bus::TappedBus>(carrier);
  std::mt19937_64::result_type seed = 0;
  for (const auto topic : {bus::kContacts.name, bus::kNodePositions.name}) {
    tapped->set_tap(
        topic, bus::lose_tap([loss, random = std::mt19937_64(++seed)](const bus::Passing&) mutable {
          return static_cast<double>(random() % 1000) < 1000 * loss;
        }));
  }
  return tapped;
}

struct Seen {
  double before = 0, greatest_after = 0, last = 0;  ///< force on the hand [N]
  double tissues_greatest = 0;                      ///< of deformation, after it [N]
  double gap_at_first = 1;                          ///< least, of the first search's contacts [m]
  bool said = false;  ///< collision's status told of a probe begun inside
};

/// @param loss  share of contacts and node positions that never arrive, at random
Seen run(const std::string& module, double depth, double silence, double loss = 0) {
  auto scene = scene::load_scene(data_file("scenes/stomach_probe.yaml"));
  const session::Assets assets = session::load_assets(scene);
  session::InProcessOptions options;
  options.make = [&](std::string_view name, bus::Bus& bus, const session::MakeStage& usual) {
    auto stage = usual(bus);
    if (name != module) return stage;
    return std::unique_ptr<runtime::Stage>(std::make_unique<Restarted>(std::move(stage), silence));
  };
  if (loss > 0) options.tap = [=](bus::Bus& carrier) { return losing(carrier, loss); };
  session::InProcess session(scene, assets, options);
  const Vec3 from = rigs::poker_at(assets.organs[0].surface, rigs::kOnStomach, -0.002);
  const Vec3 to = rigs::poker_at(assets.organs[0].surface, rigs::kOnStomach, depth);
  auto device = std::make_unique<haptics::PlacedDevice>(Pose{from, Quat::Identity()});
  haptics::PlacedDevice& hand = *device;
  session.haptics().set_device(0, std::move(device));
  Seen seen;
  const double back = kRestart + silence;
  while (session.time() < back + kBack) {
    const double now = session.time();
    const double way = std::clamp(now / 0.5, 0.0, 1.0);
    hand.place({from + way * (to - from), Quat::Identity()},
               {way < 1 ? Vec3(2 * (to - from)) : Vec3::Zero(), Vec3::Zero()});
    session.tick();
    const double force = session.haptic_force(0).force.norm();
    if (now < kRestart) seen.before = force;
    if (now < back) continue;
    seen.greatest_after = std::max(seen.greatest_after, force);
    seen.tissues_greatest = std::max(seen.tissues_greatest, session.world().force(0).norm());
    seen.last = force;
    // One period for deformation's reset to be heard.
    if (now < back + 0.006) {
      for (const Contact& c : session.contacts(0).contacts) {
        seen.gap_at_first = std::min(seen.gap_at_first, c.gap);
      }
    }
    const std::string guard = session.health("collision").guard;
    seen.said |= guard.find("first heard of inside") != std::string::npos;
  }
  return seen;
}

}  // namespace

TEST_CASE(
    "restart: under a pressed probe, contact is back at the first search and the force with it") {
  // Oracle: the force before the restart, held by the same tissue at the same place. It comes back
  // to within 5 %, and on the way never passes it by more than 10 %.
  for (const std::string module : {"collision", "deformation"}) {
    for (const double depth : {0.004, 0.009, 0.014, 0.020}) {
      for (const double silence : {0.0, 0.02, 0.1}) {
        const Seen seen = run(module, depth, silence);
        INFO(module << " silent for " << silence << " s, " << depth << " m deep: " << seen.before
                    << " N before, " << seen.last << " N after");
        CHECK(seen.before > 0.01);
        // A contact that held is at 0, but for node positions that travel as float32: half an ulp
        // of 0.13 m is 7e-9 m.
        CHECK(seen.gap_at_first < 1e-8);
        if (module == "deformation") CHECK(seen.said == (depth > 0.0085));  // its centre inside
        CHECK(seen.last == Approx(seen.before).epsilon(0.05));
        CHECK(seen.greatest_after <= 1.1 * seen.before);
      }
    }
  }
}

TEST_CASE("restart: though samples are lost, the hand gets what the tissue gives on the way back") {
  // Oracle: deformation's own force, mean of each advance; the hand's is in between.
  for (const double depth : {0.009, 0.014, 0.020}) {
    for (const double silence : {0.0, 0.02, 0.1}) {
      const Seen seen = run("deformation", depth, silence, 0.3);
      INFO(depth << " m deep, silent for " << silence << " s");
      CHECK(seen.greatest_after <= 1.1 * seen.tissues_greatest);
    }
  }
}

}  // namespace palpate::contact_loop
