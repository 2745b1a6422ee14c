#include "haptics/stage.h"

#include <catch2/catch.hpp>

#include "modules/bus/memory_bus.h"
#include "tests/haptics/wall_law.h"
#include "tests/times.h"

using namespace palpate;
using haptics::HapticsStage;

namespace {

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

  explicit Session(const scene::Device& device = scene::MouseDevice{}) {
    scene.probes.push_back({"finger", scene::SphereShape{}, 0.1, device});
  }

  runtime::Health tick(HapticsStage& stage, std::int64_t now_ns) {
    runtime::Cycle now;
    now.sim_time_ns = now.now_ns = now_ns;
    now.running = true;
    const auto health = stage.cycle(now);
    CHECK(states.take(state));
    CHECK(forces.take(force));
    return health;
  }

  /// The driver of the first probe speaks.
  void drive(std::int64_t now_ns, const Vec3& position) {
    ProbeState input;
    input.header.source_time_ns = now_ns;
    input.pose.position = position;
    REQUIRE(inputs.write(input));
  }

  /// A wall below the origin that pushes up with 1 N there.
  void push(std::int64_t now_ns) {
    ContactModel model;
    model.header.source_time_ns = now_ns;
    static_cast<LocalLaw&>(model) = testing::wall_law(Vec3(0, 0, -0.005), 200);
    model.anchor.position.setZero();
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

TEST_CASE("haptics stage: what a force has been is what it sent since it first ran, but pauses") {
  // Oracle: the messages; a pause makes laws old, and forces fade within the slew limit.
  Session session;
  HapticsStage stage(session.scene, session.bus, session.warnings);
  double greatest = 0;
  runtime::Health health;
  const auto run = [&](std::int64_t from, std::int64_t to, bool heard, bool running) {
    for (std::int64_t t = from; t < to; ++t) {
      if (heard) session.push(t * kMs);
      runtime::Cycle now;
      now.sim_time_ns = now.now_ns = t * kMs;
      now.running = running;
      health = stage.cycle(now);
      REQUIRE(session.forces.take(session.force));
      if (running) greatest = std::max(greatest, session.force.force.norm());
    }
  };
  run(1, 200, false, false);  // before its start
  CHECK(health.probes[0].greatest_force == 0);
  run(200, 400, true, true);
  run(400, 600, false, false);  // a pause
  REQUIRE(session.force.force.norm() == 0);
  run(600, 800, true, true);
  REQUIRE(health.probes.size() == 1);
  CHECK(health.probes[0].force == session.force.force.norm());
  CHECK(health.probes[0].greatest_force == greatest);
  CHECK(greatest == Approx(1));
  CHECK((health.probes[0].limits & (kForceStaleFade | kForceSlewLimited)) == 0);
  run(800, 2500, true, true);
  run(2500, 2600, false, true);  // deformation is silent
  CHECK((health.probes[0].limits & kForceStaleFade) != 0);
}

TEST_CASE("haptics stage: of the tissue's error the one that counted when the force was greatest") {
  // Oracle: what the laws say, the larger of two processes'.
  Session session;
  session.scene.organs.resize(2);
  session.scene.organs[1].process = 2;
  HapticsStage stage(session.scene, session.bus, session.warnings);
  ContactModel model;
  static_cast<LocalLaw&>(model) = testing::wall_law(Vec3(0, 0, -0.005), 200);
  model.anchor.position.setZero();
  runtime::Health health;
  for (std::int64_t t = 1; t <= 20; ++t) {
    model.header.source_time_ns = t * kMs;
    model.process = 1;
    model.force_error = 0.2;
    REQUIRE(session.models.write(model));
    model.process = 2;
    model.force_error = 0.3;
    REQUIRE(session.models.write(model));
    health = session.tick(stage, t * kMs);
  }
  CHECK(health.probes[0].error_of_greatest == 0.3);
}

TEST_CASE("haptics stage: a mouse's probe and a script's go where they are told, others stay") {
  // Oracle: the command; a script is given back only after longer silence than these 999 ms.
  Session session;
  scene::ScriptedDevice script;
  script.start = Vec3(0.1, 0, 0);
  session.scene.probes.push_back({"script", scene::SphereShape{}, 0.1, script});
  scene::EmulatedDevice emulated;
  emulated.start = script.start;
  session.scene.probes.push_back({"emulated", scene::SphereShape{}, 0.1, emulated});
  HapticsStage stage(session.scene, session.bus, session.warnings);
  ProbeState wanted;
  wanted.pose.position = Vec3(0.01, 0, 0);
  REQUIRE(session.inputs.write(wanted));
  for (wanted.probe = 1; wanted.probe < 3; ++wanted.probe) {
    REQUIRE(session.inputs.write(wanted));
  }
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
  CHECK(x[1] == Approx(0.01).margin(1e-6));
  CHECK(x[2] == 0.1);
}

TEST_CASE("haptics stage: a real device is where its driver said, at the same tick") {
  // Oracle: the samples; the mouse test above is the one that is smoothed.
  Session session{scene::TopicDevice{}};
  HapticsStage stage(session.scene, session.bus, session.warnings);
  for (std::int64_t t = 1; t <= 50; ++t) {
    const Vec3 position(1e-3 * static_cast<double>(t), 0, 0);
    session.drive(t * kMs, position);
    session.tick(stage, t * kMs);
    CHECK(session.state.pose.position == position);
  }
}

TEST_CASE("haptics stage: in a session that ran before, it waits for a driver's first word") {
  // Oracle: the stated rule: a probe that nobody has told of is not where the scene begins.
  Session session{scene::TopicDevice{}};
  HapticsStage stage(session.scene, session.bus, session.warnings);
  runtime::Cycle now;
  now.running = now.joined = true;
  for (std::int64_t t = 1; t <= 20; ++t) {
    const Vec3 position(0, 0, 1e-3);
    if (t == 11) session.drive(t * kMs, position);
    now.sim_time_ns = now.now_ns = t * kMs;
    stage.cycle(now);
    CHECK(session.states.take(session.state) == (t >= 11));
    REQUIRE(session.forces.take(session.force));
    if (t >= 11) CHECK(session.state.pose.position == position);
    if (t < 11) CHECK(session.force.force.isZero(0));
  }
}

TEST_CASE("haptics stage: several drivers of one probe are named, a driver's successor is not") {
  // Oracle: the stated rule, whichever of them is heard last in a tick.
  Session session{scene::TopicDevice{}};
  HapticsStage stage(session.scene, session.bus, session.warnings);
  auto second = session.bus.writer(bus::kProbeInput);
  const auto guard_at = [&](std::int64_t ms, bool first_speaks, bool second_speaks) {
    const auto drive_second = [&] {
      ProbeState input;
      input.header.source_time_ns = ms * kMs;
      REQUIRE(second.write(input));
    };
    if (second_speaks && ms % 2 == 0) drive_second();
    if (first_speaks) session.drive(ms * kMs, Vec3::Zero());
    if (second_speaks && ms % 2 == 1) drive_second();
    return std::string(session.tick(stage, ms * kMs).guard);
  };
  const std::string several = "probe 'finger': several programs move it on probe_input";
  std::int64_t ms = 1;
  for (; ms <= 100; ++ms) CHECK(guard_at(ms, true, false).empty());
  for (; ms <= 1300; ++ms) CHECK(guard_at(ms, false, true).find(several) == std::string::npos);
  for (; ms <= 1310; ++ms) guard_at(ms, true, true);
  CHECK(guard_at(ms++, true, true).find(several) == 0);
  for (const std::int64_t last = ms + 1010; ms < last; ++ms) guard_at(ms, true, false);
  CHECK(guard_at(ms, true, false).empty());
}

TEST_CASE("haptics stage: without a driver there is no force, and the status names the probe") {
  // Oracle: the stated rule.
  Session session{scene::TopicDevice{}};
  HapticsStage stage(session.scene, session.bus, session.warnings);
  for (std::int64_t t = 1; t <= 20; ++t) {
    session.push(t * kMs);
    const auto health = session.tick(stage, t * kMs);
    CHECK(session.force.force.norm() == 0);
    CHECK((session.force.limits & kDriverSilent) != 0);
    CHECK(std::string(health.guard).find("probe 'finger': its driver is silent so far") == 0);
  }
}

TEST_CASE("haptics stage: a driver that falls silent is let go, and comes back with a ramp") {
  // Oracle: stale_after + fade_time = 0.1 s after its last word; no step over the slew limit; back
  // to the law's 1 N within fade_time. The law is fresh all the time; the driver's clock is its
  // own, and after the silence another one.
  Session session{scene::TopicDevice{}};
  HapticsStage stage(session.scene, session.bus, session.warnings);
  double before = 0;
  const auto step = [&](std::int64_t t, bool speaks, std::int64_t stamp_ns) {
    session.push(t * kMs);
    if (speaks) session.drive(stamp_ns, Vec3::Zero());
    const auto health = session.tick(stage, t * kMs);
    const double now = session.force.force.norm();
    CHECK(std::abs(now - before) <= 0.2 + 1e-12);
    before = now;
    return health;
  };
  for (std::int64_t t = 1; t <= 100; ++t) step(t, true, 77'000 * kMs + t * kMs);
  CHECK(before == Approx(1));
  for (std::int64_t t = 101; t <= 150; ++t) step(t, false, 0);
  CHECK(before == Approx(1));
  runtime::Health health;
  for (std::int64_t t = 151; t <= 200; ++t) health = step(t, false, 0);
  CHECK(before == Approx(0).margin(1e-12));
  CHECK(std::string(health.guard).find("finger") != std::string::npos);
  for (std::int64_t t = 201; t <= 300; ++t) step(t, false, 0);
  for (std::int64_t t = 301; t <= 310; ++t) step(t, true, t * kMs - 250 * kMs);
  CHECK(before == Approx(10 / 50.0));
  for (std::int64_t t = 311; t <= 351; ++t) health = step(t, true, t * kMs - 250 * kMs);
  CHECK(before == Approx(1));
  CHECK(std::string(health.guard).empty());
}

TEST_CASE("haptics stage: a refused sample is reported by the probe that it names") {
  // Oracle: the bit and the text; a stamp that goes back.
  Session session{scene::TopicDevice{}};
  HapticsStage stage(session.scene, session.bus, session.warnings);
  session.drive(5 * kMs, Vec3::Zero());
  session.tick(stage, 5 * kMs);
  for (std::int64_t t = 6; t < 80; ++t) {
    session.drive(t * kMs, Vec3::Zero());
    session.tick(stage, t * kMs);
  }
  session.drive(70 * kMs, Vec3::Zero());
  const auto health = session.tick(stage, 80 * kMs);
  CHECK(session.force.limits == kPoseRefused);
  CHECK(std::string(health.guard).find("probe 'finger': a sample") == 0);
}

TEST_CASE("haptics stage: a reset lets go within the slew limit") {
  // Oracle: 1 N at 0.2 N a tick, five ticks.
  Session session;
  HapticsStage stage(session.scene, session.bus, session.warnings);
  for (std::int64_t t = 1; t <= 20; ++t) {
    session.push(t * kMs);
    session.tick(stage, t * kMs);
  }
  for (std::int64_t i = 1; i <= 6; ++i) {
    runtime::Cycle now;
    now.now_ns = (20 + i) * kMs;
    now.reset = i == 1;
    stage.cycle(now);
    REQUIRE(session.forces.take(session.force));
    CHECK(session.force.force.z() == Approx(std::max(0.0, 1 - 0.2 * double(i))).margin(1e-12));
  }
}

TEST_CASE("haptics stage: who is told to end takes leave with a force of zero") {
  // Oracle: the slew limit, 0.2 N a tick from 1 N; done once a zero was said.
  Session session;
  HapticsStage stage(session.scene, session.bus, session.warnings);
  std::int64_t now = 0;
  for (int i = 0; i < 20; ++i) {
    session.push(now += kMs);
    session.tick(stage, now);
  }
  REQUIRE(session.force.force.z() == Approx(1));
  int ticks = 0;
  runtime::Cycle cycle;
  bool is_done = false;
  while (!is_done && ++ticks < 100) {
    session.push(now += kMs);  // laws may still come
    cycle.sim_time_ns = cycle.now_ns = now;
    const double before = session.force.force.z();
    is_done = stage.take_leave(cycle);
    REQUIRE(session.forces.take(session.force));
    CHECK(session.force.force.z() == Approx(std::max(0.0, before - 0.2)).margin(1e-12));
  }
  CHECK(is_done);
  CHECK(ticks <= 7);
  CHECK(session.force.force.isZero(0));
}

TEST_CASE("haptics stage: while the session is paused the law grows stale and the force fades") {
  // Oracle: stale_after + fade_time by the clock of source times; session time stands still.
  Session session;
  HapticsStage stage(session.scene, session.bus, session.warnings);
  for (std::int64_t t = 1; t <= 20; ++t) {
    session.push(t * kMs);
    session.tick(stage, t * kMs);
  }
  for (std::int64_t t = 21; t <= 130; ++t) {
    runtime::Cycle now;
    now.sim_time_ns = 20 * kMs;
    now.now_ns = t * kMs;
    stage.cycle(now);
    REQUIRE(session.forces.take(session.force));
    if (t <= 70) CHECK(session.force.force.z() == Approx(1));
    if (t >= 120) CHECK(session.force.force.norm() < 1e-12);
  }
}
