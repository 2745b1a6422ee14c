#include "modules/recording/hearing.h"

#include <catch2/catch.hpp>

#include "modules/bus/memory_bus.h"

namespace palpate::recording {
namespace {

void say(bus::Writer<ModuleStatus>& writer, const char* module, ModuleState state) {
  ModuleStatus status;
  status.header.source_time_ns = 1;
  status.module = module;
  status.state = state;
  REQUIRE(writer.write(status));
}

}  // namespace

TEST_CASE("hearing: complete once all are ready and all their writers are met") {
  // Oracle: definition, one condition after the other, on a bus where all is heard at once.
  bus::MemoryBus bus;
  SessionReader reader(bus);
  Hearing hearing(bus, {"haptics", "collision"});
  CHECK_FALSE(hearing.complete(reader));
  auto haptics = bus.writer(bus::kModuleStatus), collision = bus.writer(bus::kModuleStatus);
  auto scene = bus.writer(bus::kScene);
  auto control = bus.writer(bus::kSessionControl);
  auto poses = bus.writer(bus::kProbeState);
  auto forces = bus.writer(bus::kHapticForce);
  say(haptics, "haptics", ModuleState::kReady);
  say(collision, "collision", ModuleState::kStarting);
  CHECK_FALSE(hearing.complete(reader));
  say(collision, "collision", ModuleState::kReady);
  CHECK_FALSE(hearing.complete(reader));  // nobody writes contacts
  auto contacts = bus.writer(bus::kContacts);
  CHECK(hearing.complete(reader));
}

TEST_CASE("hearing: topics that are not recorded are not waited for") {
  // Oracle: definition.
  bus::MemoryBus bus;
  SessionReader reader(bus, [](std::string_view topic) { return topic == bus::kHapticForce.name; });
  Hearing hearing(bus, {"haptics"});
  auto haptics = bus.writer(bus::kModuleStatus);
  say(haptics, "haptics", ModuleState::kRunning);
  CHECK_FALSE(hearing.complete(reader));
  auto forces = bus.writer(bus::kHapticForce);
  CHECK(hearing.complete(reader));
}

}  // namespace palpate::recording
