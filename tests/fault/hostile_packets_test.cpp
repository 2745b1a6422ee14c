// Packets from a program on the same host that takes no part in the session.
#include <catch2/catch.hpp>
#include <iostream>

#include "modules/core/units.h"
#include "tests/modules/bus/hostile_packets.h"
#include "tests/modules/bus/stranger.h"
#include "tests/system/resident_memory.h"
#include "tests/system/running_session.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::bus::testing;

namespace {

constexpr int kPerRound = 40;   // to each port
constexpr int kLookEvery = 20;  // rounds: at memory

struct Grown {
  std::map<std::string, double> before;
  double most = 1;

  void look(RunningSession& session) {
    for (const char* const name : {"deformation", "collision", "haptics"}) {
      const double now = resident_memory(session.child(name).process_id());
      const double then = before.emplace(name, now).first->second;
      most = std::max(most, now / then);
    }
  }
};

}  // namespace

TEST_CASE("hostile packets: a session goes on pressing under a hundred thousand of them") {
  // Oracle: nobody ends, the force stays that of the same pose without them to a tenth and is never
  // gone for a second, memory grows by less than half, and every process says that it refused some.
  // The first of them ended all processes at once before the
  // filter; farewells in others' names made them deaf.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  const double force = session.rest_pressed(0.05);
  REQUIRE(force > 0);
  Stranger stranger(session.options().domain);
  const std::vector<Bytes> overheard = stranger.overhear(40);
  REQUIRE(overheard.size() >= 4);
  std::mt19937_64 random(1);
  const int rounds = packets_to_send(96'000) / (kPerRound * Stranger::kPorts);
  double gone = 0;
  Grown grown;
  session.forget_largest();
  for (int round = 0; round < rounds; ++round) {
    if (round % kLookEvery == 0) grown.look(session);
    for (int k = 0; k < kPerRound; ++k) {
      const Bytes packet = any_packet(random, overheard);
      for (int port = 0; port < Stranger::kPorts; ++port) {
        stranger.send(packet, Stranger::kFirstOffset + port);
      }
    }
    session.listen_for(0.02);
    const std::int64_t pushed_ns = session.heard().last_pushed_ns;
    gone = std::max(gone, seconds_from_ns(runtime::monotonic_now_ns() - pushed_ns));
  }
  grown.look(session);
  const std::uint64_t then = session.heard().force.header.sequence;
  CHECK(session.wait([&](const Heard& heard) {
    return heard.force.header.sequence > then + 1000 && heard.modules.size() == 3;
  }));
  CHECK(session.all_go_on_refusing(1000));
  CHECK(session.heard().force.force.norm() == Approx(force).epsilon(0.1));
  CHECK(session.heard().largest_force < 1.1 * force);
  CHECK(gone < 1);
  CHECK(grown.most < 1.5);
  std::cout << rounds * kPerRound * Stranger::kPorts << " packets from a stranger: memory at most "
            << grown.most << " times as much, longest without a force " << gone
            << " s, largest force " << session.heard().largest_force / force << " of what it was\n";
}
