// Packets from a program on the same host that takes no part in the session.
#include "tests/modules/bus/hostile_packets.h"
#include "tests/modules/bus/stranger.h"
#include "tests/system/running_session.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::bus::testing;

namespace {

constexpr int kRounds = 60;  // of some tens of packets to each port: 96,000 in all
constexpr int kPerRound = 40;

}  // namespace

TEST_CASE("hostile packets: a session goes on pressing under a hundred thousand of them") {
  // Oracle: nobody ends, the force stays that of the same pose without them to a tenth, and every
  // process says that it refused some. The first of them ended all processes at once before the
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
  for (int round = 0; round < kRounds; ++round) {
    for (int k = 0; k < kPerRound; ++k) {
      const Bytes packet = any_packet(random, overheard);
      for (int port = 0; port < Stranger::kPorts; ++port) {
        stranger.send(packet, Stranger::kFirstOffset + port);
      }
    }
    session.listen_for(0.02);
  }
  const std::uint64_t then = session.heard().force.header.sequence;
  CHECK(session.wait([&](const Heard& heard) {
    return heard.force.header.sequence > then + 1000 && heard.modules.size() == 3;
  }));
  CHECK(session.all_go_on_refusing(1000));
  CHECK(session.heard().force.force.norm() == Approx(force).epsilon(0.1));
}
