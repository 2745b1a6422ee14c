#include "haptics/stage.h"

#include <catch2/catch.hpp>

#include "modules/bus/memory_bus.h"

using namespace palpate;
using haptics::HapticsStage;

namespace {

constexpr std::int64_t kMs = 1'000'000;

struct Session {
  scene::Scene scene;
  bus::MemoryBus bus;
  bus::Writer<ContactModel> models = bus.writer(bus::kContactModel);
  bus::Writer<ProbeState> inputs = bus.writer(bus::kProbeInput);
  bus::Reader<ProbeState> states = bus.reader(bus::kProbeState);
  bus::Reader<HapticForce> forces = bus.reader(bus::kHapticForce);
  std::vector<std::string> warnings;
  ProbeState state;
  HapticForce force;

  Session() { scene.probes.push_back({"finger", scene::SphereShape{}, 0.1, scene::TopicDevice{}}); }

  runtime::Health tick(HapticsStage& stage, std::int64_t now_ns) {
    runtime::Cycle now;
    now.sim_time_ns = now.now_ns = now_ns;
    now.running = true;
    const auto health = stage.cycle(now);
    CHECK(states.take(state));
    CHECK(forces.take(force));
    return health;
  }

  /// A wall below the origin that pushes up with 1 N there.
  void push(std::int64_t now_ns) {
    ContactModel model;
    model.header.source_time_ns = now_ns;
    model.touching = true;
    model.force = Vec3(0, 0, 1);
    model.validity_radius = 0.01;
    REQUIRE(models.write(model));
  }
};

}  // namespace

TEST_CASE("haptics stage: renders the newest law at the pose it has just published") {
  // Oracle: the law, 1 N upward, reached by the slew limit's 0.2 N a tick.
  Session session;
  HapticsStage stage(session.scene, session.bus, session.warnings);
  session.push(kMs);
  for (std::int64_t t = 1; t <= 20; ++t) {
    session.tick(stage, t * kMs);
    CHECK(session.state.header.sim_time_ns == t * kMs);
    CHECK(session.force.header.sim_time_ns == t * kMs);
  }
  CHECK(session.force.force.z() == Approx(1));
}

TEST_CASE("haptics stage: a law that nobody renews fades, and the status says so") {
  // Oracle: stale_after + fade_time of the scene's defaults, 0.1 s.
  Session session;
  HapticsStage stage(session.scene, session.bus, session.warnings);
  session.push(kMs);
  runtime::Health health;
  for (std::int64_t t = 1; t <= 110; ++t) health = session.tick(stage, t * kMs);
  CHECK(session.force.force.norm() == 0);
  CHECK(std::string(health.guard).find("stale_after_s") != std::string::npos);
}

TEST_CASE("haptics stage: a probe driven from outside goes where it is told, others stay") {
  // Oracle: the command.
  Session session;
  scene::ScriptedDevice script;
  script.start = Vec3(0.1, 0, 0);
  session.scene.probes.push_back({"script", scene::SphereShape{}, 0.1, script});
  HapticsStage stage(session.scene, session.bus, session.warnings);
  ProbeState wanted;
  wanted.pose.position = Vec3(0.01, 0, 0);
  REQUIRE(session.inputs.write(wanted));
  wanted.probe = 1;
  REQUIRE(session.inputs.write(wanted));
  for (std::int64_t t = 0; t < 1000; ++t) {
    runtime::Cycle now;
    now.sim_time_ns = now.now_ns = t * kMs;
    stage.cycle(now);
  }
  std::map<std::uint32_t, double> x;
  while (session.states.take(session.state)) {
    x[session.state.probe] = session.state.pose.position.x();
  }
  CHECK(x[0] == Approx(0.01).margin(1e-6));
  CHECK(x[1] == 0.1);
}
