#include "palpate/session_monitor.h"

#include <catch2/catch.hpp>

#include "modules/bus/dds_bus.h"
#include "tests/modules/runtime/own_bus.h"

using namespace palpate;
using namespace palpate::launcher;

TEST_CASE(
    "session monitor: names a module that two processes are, not one that was started again") {
  // Oracle: what was written: the second one speaks while the first does, or after its end.
  const auto options = palpate::testing::own_bus_options();
  bus::DdsBus bus(options), first_bus(options), second_bus(options);
  SessionMonitor monitor(bus, {});
  std::int64_t said = 0;
  auto first = first_bus.writer(bus::kModuleStatus), second = second_bus.writer(bus::kModuleStatus);
  const auto say = [&](bus::Writer<ModuleStatus>& statuses, const char* module) {
    ModuleStatus status;
    status.module = module;
    status.state = ModuleState::kReady;
    status.process_id = ++said;
    statuses.write(status);
    CHECK(palpate::testing::wait_until([&] {
      monitor.poll();
      const ModuleTally* heard = monitor.tally().module(module);
      return heard != nullptr && heard->newest.process_id == said;
    }));
  };
  for (const char* module : {"haptics", "visualizer"}) {
    for (auto* statuses : {&first, &first, &second, &second}) say(*statuses, module);
    CHECK(monitor.several().empty());
  }
  for (auto* statuses : {&first, &second}) say(*statuses, "visualizer");
  CHECK(monitor.several().empty());
  say(first, "haptics");
  CHECK(monitor.several() == std::vector<std::string>{"haptics"});
  REQUIRE(monitor.take_warnings().size() == 1);
  CHECK(monitor.take_warnings().empty());
  monitor.tally().start();
  static_cast<void>(monitor.take_warnings());
  REQUIRE(monitor.tally().troubles().size() == 1);
  CHECK(monitor.tally().troubles()[0].starts_with("haptics: several processes are it"));
}

TEST_CASE("session monitor: knows who is ready, and hears no physics") {
  // Oracle: what was written.
  const auto options = palpate::testing::own_bus_options();
  bus::DdsBus bus(options), module_bus(options);
  scene::Scene scene;
  scene.organs.resize(1);
  scene.probes.resize(1);
  SessionMonitor monitor(bus, scene);
  const std::vector<std::string> both{"haptics", "collision"};
  CHECK(monitor.not_ready(both) == both);
  CHECK(monitor.waited_for(both) == both);

  auto statuses = module_bus.writer(bus::kModuleStatus);
  const auto forces = module_bus.writer(bus::kHapticForce);
  const auto positions = module_bus.writer(bus::kNodePositions);
  ModuleStatus status;
  status.module = "haptics";
  status.state = ModuleState::kReady;
  statuses.write(status);
  status.module = "collision";
  status.state = ModuleState::kStarting;
  statuses.write(status);
  const std::vector<std::string> three{"haptics", "collision", "deformation"};
  CHECK(palpate::testing::wait_until([&] {
    monitor.poll();
    return monitor.not_ready(both) == std::vector<std::string>{"collision"};
  }));
  CHECK(monitor.waited_for(both) == std::vector<std::string>{"collision"});
  // It has started, and waits for what another host has to say.
  CHECK(palpate::testing::wait_until([&] {
    monitor.poll();
    return monitor.waited_for(three) == std::vector<std::string>{"deformation"};
  }));
  status.state = ModuleState::kReady;
  statuses.write(status);
  CHECK(palpate::testing::wait_until([&] {
    monitor.poll();
    return monitor.not_ready(both).empty();
  }));

  // Who plays another scene takes no part, nor does who has ended.
  for (const ModuleState state : {ModuleState::kFault, ModuleState::kStopped}) {
    status.state = ModuleState::kReady;
    statuses.write(status);
    CHECK(palpate::testing::wait_until([&] {
      monitor.poll();
      return monitor.not_ready(both).empty();
    }));
    status.state = state;
    status.last_error = "another scene";
    statuses.write(status);
    CHECK(palpate::testing::wait_until([&] {
      monitor.poll();
      return monitor.not_ready(both) == std::vector<std::string>{"collision"};
    }));
    CHECK(monitor.waited_for(three) ==
          std::vector<std::string>{"collision (another scene)", "deformation"});
  }
  CHECK(palpate::testing::wait_until([&] {
    return monitor.silent() == std::vector<std::string>{"collision", "haptics"};
  }));

  // The haptic loop sends nothing more for it.
  CHECK(forces.matched_readers() + positions.matched_readers() == 0);
}
