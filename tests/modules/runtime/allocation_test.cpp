// The loop of a module may not allocate: counts operator new in the calling thread.
#include <algorithm>
#include <catch2/catch.hpp>

#include "modules/runtime/module.h"
#include "modules/scene/scene.h"
#include "tests/counted_allocations.h"
#include "tests/modules/bus/loopback.h"

using namespace palpate;
using namespace palpate::runtime;
using palpate::testing::allocations;

TEST_CASE("allocation: a running module allocates nothing but what DDS takes for a status") {
  // Oracle: the count of operator new, over a second with four statuses.
  ModuleOptions options;
  options.bus = bus::testing::own_options();
  options.realtime = false;
  Module module(options, scene::Scene{}, "haptics", 500, Priority::kPreferred);
  auto models = module.bus().reader(bus::kContactModel);
  module.ready();
  bus::DdsBus listener(options.bus);
  auto statuses = listener.reader(bus::kModuleStatus);
  Session session(listener, "");
  SessionConductor conductor(listener);
  conductor.command(session.state(), SessionCommand::kStart);
  REQUIRE(bus::testing::wait_until([&] { return module.next_cycle() && module.running(); }));
  for (int i = 0; i < 250; ++i) module.next_cycle();  // two statuses to warm up

  ModuleStatus first, last;
  while (statuses.take(first)) {
  }
  int cycles_that_allocated = 0;
  std::size_t most = 0;
  for (int i = 0; i < 500; ++i) {
    module.set_guard(i % 100 < 50 ? "an input is stale" : "");
    const std::size_t before = allocations();
    module.next_cycle();
    cycles_that_allocated += allocations() > before;
    most = std::max(most, allocations() - before);
  }
  REQUIRE(bus::testing::take_soon(statuses, last));
  while (bus::testing::take_soon(statuses, last, 0.2)) {  // the last one may still be on its way
  }
  const auto written = static_cast<int>(last.header.sequence - first.header.sequence);
  CHECK(written >= 3);
  CHECK(cycles_that_allocated <= written);  // only DDS, and only in a status
  CHECK(most <= 32);
}
