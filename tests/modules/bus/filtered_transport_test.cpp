#include "modules/bus/filtered_transport.h"

#include "tests/modules/bus/loopback.h"
#include "tests/modules/bus/stranger.h"

namespace palpate::bus {
namespace {

using namespace testing;

template <class Send>
void to_every_port(const Send& send) {
  for (int port = 0; port < Stranger::kPorts; ++port) send(Stranger::kFirstOffset + port);
}

}  // namespace

TEST_CASE("transport: own traffic passes without one packet refused", "[bus]") {
  // Oracle: the counters of both sides, after matching and messages of one and of many datagrams.
  Pair<NodePositions> pair(kNodePositions);
  REQUIRE(pair.matched);
  NodePositions message;
  message.positions.assign(3 * 19'362, 0.5f);
  NodePositions received;
  for (int k = 0; k < 50; ++k) {
    REQUIRE(pair.writer.write(message));
    REQUIRE(take_soon(pair.reader, received));
  }
  CHECK(pair.writer_bus.packets_refused().count == 0);
  CHECK(pair.reader_bus.packets_refused().count == 0);
}

TEST_CASE("transport: the packet that aborted every process is refused, counted and named",
          "[bus]") {
  // Oracle: the counter, and a sample that comes after it. Sent to each port that may be one of
  // the bus's, and to the group that it does not listen to.
  const BusOptions options = own_options();
  Pair<ProbeState> pair(kProbeState, options);
  REQUIRE(pair.matched);
  Stranger stranger(options.domain);
  stranger.send_to_group(statistics_and_more());
  stranger.send(statistics_and_more(), 0);
  to_every_port([&](int port) { stranger.send(statistics_and_more(), port); });
  to_every_port([&](int port) { stranger.send(joined({header(), gap(1, 1LL << 62)}), port); });
  CHECK(wait_until([&] { return pair.reader_bus.packets_refused().count >= 4; }));
  CHECK(std::string(pair.reader_bus.packets_refused().last) == text_of(PacketFault::kGap));
  ProbeState state, received;
  REQUIRE(pair.writer.write(state));
  CHECK(take_soon(pair.reader, received));
}

TEST_CASE("transport: a stranger cannot end a participant in its name", "[bus]") {
  // Oracle: its samples go on. Without the rule its readers forget it at the first farewell
  // (a participant's own words, replayed and changed).
  const BusOptions options = own_options();
  Pair<ProbeState> pair(kProbeState, options);
  REQUIRE(pair.matched);
  Stranger stranger(options.domain);
  const std::vector<Bytes> announcements = stranger.overhear(8);
  REQUIRE(announcements.size() >= 2);
  for (const Bytes& announcement : announcements) {
    const Bytes prefix(announcement.begin() + 8, announcement.begin() + 20);
    to_every_port([&](int port) {
      stranger.send(joined({header(prefix), farewell(prefix)}), port);
    });
    to_every_port([&](int port) { stranger.send(joined({header(), farewell(prefix)}), port); });
    to_every_port([&](int port) { stranger.send(announcement, port); });
  }
  CHECK(wait_until([&] { return pair.reader_bus.packets_refused().count >= 6; }));
  CHECK(pair.reader.matched_writers() == 1);
  CHECK(pair.writer.matched_readers() == 1);
  ProbeState state, received;
  REQUIRE(pair.writer.write(state));
  CHECK(take_soon(pair.reader, received, 2));
}

}  // namespace palpate::bus
