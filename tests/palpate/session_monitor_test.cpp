#include "palpate/session_monitor.h"

#include <catch2/catch.hpp>

#include "modules/bus/dds_bus.h"
#include "tests/modules/runtime/own_bus.h"

using namespace palpate;
using namespace palpate::launcher;

TEST_CASE("session monitor: knows who is ready and hears forces and nodes") {
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
  auto forces = module_bus.writer(bus::kHapticForce);
  auto positions = module_bus.writer(bus::kNodePositions);
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

  HapticForce force;
  force.force = Vec3(0, 0, 2);
  NodePositions nodes;
  nodes.volume = 1.5;
  nodes.target_volume = 1;
  nodes.positions = {0, 0, 0};
  CHECK(palpate::testing::wait_until([&] {
    forces.write(force);
    positions.write(nodes);
    monitor.poll();
    const auto& tally = monitor.tally();
    return tally.probes()[0].force == 2 && tally.organs()[0].volume_ratio == 1.5;
  }));
}

TEST_CASE("session monitor: one that hears statuses alone is no reader of physics until it asks") {
  // Oracle: how many readers the modules' writers have met. Modules in lockstep count them.
  const auto options = palpate::testing::own_bus_options();
  bus::DdsBus bus(options), module_bus(options);
  scene::Scene scene;
  scene.organs.resize(1);
  auto statuses = module_bus.writer(bus::kModuleStatus);
  auto laws = module_bus.writer(bus::kContactModel);
  auto positions = module_bus.writer(bus::kNodePositions);
  auto forces = module_bus.writer(bus::kHapticForce);
  SessionMonitor monitor(bus, scene, SessionMonitor::Hears::kStatuses);
  const auto met = [&] {
    return laws.matched_readers() + positions.matched_readers() + forces.matched_readers();
  };
  REQUIRE(palpate::testing::wait_until([&] { return statuses.matched_readers() == 1; }));
  CHECK_FALSE(palpate::testing::wait_until([&] { return met() > 0; }, 0.5));
  monitor.hear_all(bus);
  CHECK(palpate::testing::wait_until([&] { return met() == 3; }));
}
