// Packets from a program on the same host that takes no part in the session.
#include <random>

#include "tests/modules/bus/stranger.h"
#include "tests/system/running_session.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::bus::testing;

namespace {

constexpr int kRounds = 60;  // of some tens of packets to each port: 96,000 in all
constexpr int kPerRound = 40;

// A sub-message of the kinds that move something in a participant, with numbers of any size.
Bytes any_message(std::mt19937_64& random, const Bytes& prefix) {
  const auto number = [&] { return static_cast<std::int64_t>(random() >> (random() % 64)); };
  switch (random() % 10) {
    case 0:
      return farewell(prefix);
    case 1:
      return announcement(prefix);
    case 2:
      return heartbeat(number(), number());
    case 3:
      return acknack(number(), static_cast<std::uint32_t>(random() % 300));
    case 4:
      return gap(number(), number(), static_cast<std::uint32_t>(random() % 300));
    case 5:
      return statistics();
    case 6:
      return data_frag(number(), 1, 1, 1000, static_cast<std::uint32_t>(number()), Bytes(1000));
    case 7:
      return data(0x000003c2, number(), Bytes(random() % 200));
    case 8:
      return data(kUserWriter, number(), Bytes(random() % 200));
    default:
      return timestamp();
  }
}

// What was overheard, with some bytes changed, or words made up in somebody's name.
Bytes any_packet(std::mt19937_64& random, const std::vector<Bytes>& overheard) {
  const Bytes& model = overheard[random() % overheard.size()];
  const Bytes prefix(model.begin() + 8, model.begin() + 20);
  const std::uint64_t kind = random() % 20;
  if (kind == 0) return statistics_and_more();
  if (kind < 10) {
    return joined({header(kind < 7 ? prefix : Bytes(12, std::uint8_t(random()))),
                   any_message(random, prefix), any_message(random, prefix)});
  }
  Bytes packet = model;
  for (std::uint64_t k = 1 + random() % 6; k > 0; --k) {
    packet[4 + random() % (packet.size() - 4)] = static_cast<std::uint8_t>(random());
  }
  if (kind == 10) packet.resize(1 + random() % packet.size());
  return packet;
}

}  // namespace

TEST_CASE("hostile packets: a session goes on pressing under a hundred thousand of them") {
  // Oracle: nobody ends, the force stays that of the same pose without them to a tenth, and every
  // process says that it refused some. The first of them ended all processes at once before the
  // filter; farewells in others' names made them deaf.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  REQUIRE(session.press(0.05));
  session.wait([](const Heard&) { return false; }, 1);  // until it rests
  const double force = session.heard().force.force.norm();
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
    session.wait([](const Heard&) { return false; }, 0.02);
  }
  const std::uint64_t then = session.heard().force.header.sequence;
  CHECK(session.wait([&](const Heard& heard) {
    return heard.force.header.sequence > then + 1000 && heard.modules.size() == 3;
  }));
  for (const char* name : {"deformation", "collision", "haptics"}) {
    CHECK_FALSE(session.child(name).ended().has_value());
    CHECK(session.wait(
        [&](const Heard& heard) { return heard.modules.at(name).packets_refused > 1000; }));
    CHECK(session.heard().modules.at(name).state == ModuleState::kRunning);
  }
  CHECK(session.heard().force.force.norm() == Approx(force).epsilon(0.1));
}
