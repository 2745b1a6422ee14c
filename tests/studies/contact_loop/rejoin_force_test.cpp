// What the hand feels when deformation or collision return under a pressed tool.
#include <algorithm>
#include <catch2/catch.hpp>

#include "haptics/devices/placed_device.h"
#include "modules/core/data_folder.h"
#include "modules/runtime/kept_state.h"
#include "modules/scene/scene_reader.h"
#include "palpate/session/in_process.h"
#include "studies/contact_loop/contact_loop.h"
#include "studies/rigs/poked_organ.h"

namespace palpate::contact_loop {
namespace {

constexpr double kLeave = 2.0;      // [s]
constexpr double kForceBack = 1.0;  // within which the force is to be back [s]

/// A process that says nothing for a while from kLeave on: stopped, it goes on; killed, it begins
/// anew, a deformation with what it kept.
class Away final : public runtime::Stage {
 public:
  Away(std::unique_ptr<runtime::Stage> stage, double silence, bool killed, bool keeps)
      : stage_(std::move(stage)), silence_(silence), killed_(killed), keeps_(keeps) {}

  runtime::Health cycle(const runtime::Cycle& now) override {
    if (now.time() >= kLeave && now.time() < kLeave + silence_) return {};
    runtime::Cycle own = now;
    if (now.time() >= kLeave && killed_) {
      killed_ = false;
      own.reset = !kept_.give_back(*stage_, now.now_ns);
      kept_.tell({}, own);
    }
    const runtime::Health health = stage_->cycle(own);
    if (keeps_) kept_.keep(*stage_, {}, now.now_ns);
    return health;
  }

 private:
  runtime::KeptMemory memory_;
  runtime::KeptState kept_{memory_.descriptor(), "scene"};
  std::unique_ptr<runtime::Stage> stage_;
  double silence_;
  bool killed_, keeps_;
};

struct Case {
  std::string tool, module;
  bool killed;
  double depth, silence;
};

/// On the hand [N].
struct Felt {
  double before = 0, greatest = 0, last = 0;  ///< the latter two after the return
};

class Pressed {
 public:
  explicit Pressed(const std::string& tool)
      : tool_(make_tool(tool, 0.008)),
        scene_(scene::load_scene(data_file("scenes/stomach_probe.yaml"))) {
    assets_ = session::load_assets(scene_);
    scene_.probes.clear();
    scene_.probes.push_back({"tool", tool_.shape, 0.1, scene::ScriptedDevice{}});
    assets_.probe_meshes = {tool_.mesh};
  }

  Felt felt(const Case& c) const {
    session::InProcess session(scene_, assets_, options_of(c));
    const double x = 0.008, z = -0.049;
    const double skin = rigs::front_of(assets_.organs[0].surface, x, z);
    const Vec3 from(x, skin - 0.002 - tool_.reach, z), to(x, skin + c.depth - tool_.reach, z);
    auto device = std::make_unique<haptics::PlacedDevice>(Pose{from, tool_.rotation});
    haptics::PlacedDevice& hand = *device;
    session.haptics().set_device(0, std::move(device));
    Felt felt;
    const double back = kLeave + c.silence;
    while (session.time() < back + kForceBack) {
      const double now = session.time();
      const double way = std::clamp(now / 0.5, 0.0, 1.0);
      const Vec3 velocity = way < 1 ? Vec3(2 * (to - from)) : Vec3::Zero();
      hand.place({from + way * (to - from), tool_.rotation}, {velocity, Vec3::Zero()});
      session.tick();
      const double force = session.haptic_force(0).force.norm();
      if (now < kLeave) felt.before = force;
      if (now < back) continue;
      felt.greatest = std::max(felt.greatest, force);
      felt.last = force;
    }
    return felt;
  }

 private:
  static session::InProcessOptions options_of(const Case& c) {
    session::InProcessOptions options;
    options.make = [c](std::string_view name, bus::Bus& bus,
                       const session::MakeStage& usual) -> std::unique_ptr<runtime::Stage> {
      auto stage = usual(bus);
      if (name != c.module) return stage;
      return std::make_unique<Away>(std::move(stage), c.silence, c.killed,
                                    c.module == "deformation");
    };
    return options;
  }

  Tool tool_;
  scene::Scene scene_;
  session::Assets assets_;
};

}  // namespace

TEST_CASE("rejoin: whoever returns under a pressed round tool gives back the force it had") {
  // Oracle: the force from before, which the same tissue at the same place gives again; at most a
  // tenth more on the way. A deformation that began at rest gave up to 1.4 times the force of the
  // ball, 2 of the needle and 15 of the rod, or, where the rod lay behind the wall, half of it for
  // good; a collision that returned after tissue was let go gave 1.5, 2 and 14 times.
  for (const char* tool : {"ball", "needle", "rod", "wire"}) {
    const Pressed pressed(tool);
    for (const char* module : {"deformation", "collision"}) {
      for (const bool killed : {true, false}) {
        for (const double depth : {0.004, 0.016}) {
          for (const double silence : {0.5, 2.0}) {
            const Felt felt = pressed.felt({tool, module, killed, depth, silence});
            CAPTURE(tool, module, killed, depth, silence, felt.before);
            CHECK(felt.before > 0.01);
            CHECK(felt.greatest < 1.1 * felt.before);
            CHECK(felt.last > 0.9 * felt.before);
          }
        }
      }
    }
  }
}

TEST_CASE("rejoin: under a sharp tool at rest tissue is not let go while collision is away") {
  // Oracle: the force from before, as above. Let go, it gave a box up to 2.7 times its force.
  for (const char* tool : {"box", "blade", "cone", "mesh", "grasper"}) {
    const Pressed pressed(tool);
    for (const bool killed : {true, false}) {
      for (const double depth : {0.004, 0.016}) {
        for (const double silence : {0.5, 2.0}) {
          const Felt felt = pressed.felt({tool, "collision", killed, depth, silence});
          CAPTURE(tool, killed, depth, silence, felt.before);
          CHECK(felt.before > 0.001);
          CHECK(felt.greatest < 1.1 * felt.before);
          CHECK(felt.last > 0.9 * felt.before);
        }
      }
    }
  }
}

TEST_CASE("rejoin: poses of a resting round probe that are missed for a while bring no blow") {
  // Oracle: the force from before, as above. Tissue was let go after 50 ms: found a few
  // milliseconds later it gave 5 times the force of the ball, 9 of the needle and 25 of the rod.
  for (const char* tool : {"ball", "needle", "rod"}) {
    const Pressed pressed(tool);
    for (const double depth : {0.002, 0.016}) {
      for (const double silence : {0.06, 0.08, 0.3}) {
        const Felt felt = pressed.felt({tool, "haptics", false, depth, silence});
        CAPTURE(tool, depth, silence, felt.before);
        CHECK(felt.greatest < 1.1 * felt.before);
        CHECK(felt.last > 0.9 * felt.before);
      }
    }
  }
}

}  // namespace palpate::contact_loop
