#include "modules/runtime/status_reporter.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "modules/bus/dds_bus.h"
#include "modules/runtime/clock.h"
#include "tests/modules/runtime/own_bus.h"
#include "tests/times.h"

using namespace palpate;
using namespace palpate::runtime;
using palpate::testing::own_bus_options;
using palpate::testing::wait_until;

namespace {

struct Reported {
  bus::BusOptions options = own_bus_options();
  bus::DdsBus bus{options}, reader_bus{options};
  StatusReporter reporter{bus, "collision", 100, true};
  bus::Reader<ModuleStatus> reader = reader_bus.reader(bus::kModuleStatus);
  LoopStatistics loop;
  ModuleStatus newest;

  bool take() {
    return wait_until([&] { return reader.take(newest); });
  }
};

}  // namespace

TEST_CASE("status: a change is told at once, and else only every quarter second") {
  // Oracle: sequence numbers of what was written.
  Reported r;
  const auto t0 = monotonic_now_ns();
  r.reporter.poll(t0, 0, r.loop);
  for (int ms = 1; ms < 240; ++ms) r.reporter.poll(t0 + ms * 1'000'000, 0, r.loop);
  r.reporter.set_state(ModuleState::kReady);
  r.reporter.set_state(ModuleState::kReady);  // no change
  r.reporter.poll(t0 + 240'000'000, 0, r.loop);
  r.reporter.poll(t0 + 400'000'000, 0, r.loop);
  r.reporter.poll(t0 + 490'000'000, 0, r.loop);
  CHECK(r.reporter.status().header.sequence == 3);
  REQUIRE(wait_until([&] { return r.reader.take(r.newest) && r.newest.header.sequence == 3; }));
  CHECK(r.newest.module == "collision");
  CHECK(r.newest.state == ModuleState::kReady);
  CHECK(r.newest.process_id == getpid());
  CHECK(r.newest.realtime_priority);
  CHECK(r.newest.nominal_rate_hz == 100);
}

TEST_CASE("status: rate and load are those since the last status") {
  // Oracle: by hand: 50 cycles and 0.1 s of work in half a second.
  Reported r;
  const auto t0 = monotonic_now_ns();
  r.loop.cycles = 1000;
  r.loop.busy_ns = 7 * kSecond;
  r.reporter.publish(t0, 1, r.loop);
  r.loop.cycles += 50;
  r.loop.overruns = 3;
  r.loop.busy_ns += kSecond / 10;
  r.loop.worst_lateness_ns = 2'000'000;
  r.reporter.publish(t0 + kSecond / 2, 1.5, r.loop);
  const ModuleStatus& status = r.reporter.status();
  CHECK(status.rate_hz == Approx(100));
  CHECK(status.busy_fraction == Approx(0.2));
  CHECK(status.cycles == 1050);
  CHECK(status.overruns == 3);
  CHECK(status.worst_lateness == Approx(0.002));
  CHECK(status.header.sim_time_ns == kSecond * 3 / 2);
  // What is said soon after, as where a state changes, tells the same: too little is known since.
  r.reporter.publish(t0 + kSecond / 2 + kSecond / 100, 1.5, r.loop);
  CHECK(status.rate_hz == Approx(100));
  CHECK(status.busy_fraction == Approx(0.2));
}

TEST_CASE("status: tells the age and the losses of each input") {
  // Oracle: by hand.
  Reported r;
  const auto never = r.bus.reader(bus::kContacts);
  auto known = r.bus.reader(bus::kSurface);
  for (const std::uint64_t sequence : {1, 2, 3, 4, 5, 6, 7, 8, 11, 12}) {
    known.input().accept({}, {sequence, 0, kSecond});
  }
  known.input().reject({}, "payload");
  r.reporter.publish(kSecond + kSecond / 4, 0, r.loop);
  REQUIRE(r.take());  // an infinite age crosses the wire
  REQUIRE(r.newest.inputs.size() == 2);
  CHECK(r.newest.inputs[0].topic == "contacts");
  CHECK(std::isinf(r.newest.inputs[0].age));
  CHECK(r.newest.inputs[1].age == Approx(0.25));
  CHECK(r.newest.inputs[1].received == 10);
  CHECK(r.newest.inputs[1].dropped == 2);
  CHECK(r.newest.inputs[1].rejected == 1);
}

TEST_CASE("status: an input written after the cycle began is of age zero, and the status leaves") {
  // Oracle: the codec refuses a negative age.
  Reported r;
  auto newer = r.bus.reader(bus::kContacts);
  newer.input().accept({}, {1, 0, kSecond + 1000});
  r.reporter.publish(kSecond, 0, r.loop);
  REQUIRE(r.take());
  CHECK(r.newest.inputs[0].age == 0);
}

TEST_CASE("status: tells what went wrong with contacts") {
  // Oracle: by hand.
  Reported r;
  r.reporter.set_contact_troubles({1, 2, 3});
  r.reporter.publish(kSecond, 0, r.loop);
  REQUIRE(r.take());
  CHECK(r.newest.contacts.truncated == 1);
  CHECK(r.newest.contacts.lost == 2);
  CHECK(r.newest.contacts.unsolved == 3);
}

TEST_CASE("status: an endless error is cut, not lost") {
  // Oracle: the limit it documents.
  Reported r;
  r.reporter.set_state(ModuleState::kFault, std::string(5000, 'x'));
  r.reporter.publish(monotonic_now_ns(), 0, r.loop);
  REQUIRE(r.take());
  CHECK(r.newest.last_error == std::string(StatusReporter::kMaxErrorBytes, 'x'));
  const std::string before(StatusReporter::kMaxErrorBytes - 1, 'x');  // a letter of two bytes on
  r.reporter.set_state(ModuleState::kFault, before + "\xc3\xa9");
  r.reporter.publish(monotonic_now_ns(), 0, r.loop);
  REQUIRE(r.take());
  CHECK(r.newest.last_error == before);
  CHECK(r.newest.state == ModuleState::kFault);
}
