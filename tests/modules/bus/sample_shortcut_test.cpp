#include "modules/bus/sample_shortcut.h"

#include <catch2/catch.hpp>
#include <random>

#include "modules/bus/packet_filter.h"
#include "tests/modules/bus/rtps_packets.h"

namespace palpate::bus {
namespace {

using namespace testing;

constexpr SampleShortcut::EntityId kReader = 0x00000104, kOtherReader = 0x00000204;
constexpr std::int64_t kArrived = 1'700'000'000'000'000'000;

Bytes payload(std::uint8_t value) { return Bytes(40, value); }

WriterId id_of(const Bytes& prefix, std::uint32_t entity) {
  WriterId id{};
  std::copy(prefix.begin(), prefix.end(), id.begin());
  for (std::size_t i = 0; i < 4; ++i) id[12 + i] = static_cast<std::uint8_t>(entity >> 8 * (3 - i));
  return id;
}

Bytes to(const Bytes& participant) { return submessage(0x0e, 1, Content().raw(participant)); }

Bytes data_to(std::uint32_t reader, std::int64_t sequence, const Bytes& bytes) {
  return submessage(
      0x15, 5,
      Content().two(0).two(16).entity(reader).entity(kUserWriter).sequence(sequence).raw(bytes));
}

/// A reader that is connected with kUserWriter of kSomebody.
struct Connected {
  Connected() {
    GuidPrefix own;
    std::ranges::copy(kSomebodyElse, own.begin());
    shortcut.set_participant(own);
    shortcut.connect(writer, kReader, inbox);
  }
  bool take(const Bytes& words) { return shortcut.take(joined({header(), words}), kArrived); }
  int waiting() {
    int count = 0;
    while (inbox->take(sample)) ++count;
    return count;
  }

  const WriterId writer = id_of(kSomebody, kUserWriter);
  SampleShortcut shortcut;
  std::shared_ptr<SampleInbox> inbox = std::make_shared<SampleInbox>();
  RawSample sample;
};

}  // namespace

TEST_CASE("shortcut: a plain sample of a writer that was met comes into the inbox", "[bus]") {
  // Oracle: the bytes that were put into the packet, its arrival and its writer.
  Connected there;
  CHECK(there.inbox->empty());
  CHECK(there.take(joined({timestamp(), data(kUserWriter, 1, payload(7))})));
  CHECK(there.take(joined({to(kSomebodyElse), timestamp(), data_to(kReader, 2, payload(8))})));
  CHECK_FALSE(there.inbox->empty());
  REQUIRE(there.inbox->take(there.sample));
  CHECK(there.sample.payload == payload(7));
  CHECK(there.sample.received_time_ns == kArrived);
  CHECK(there.sample.writer == there.writer);
  REQUIRE(there.inbox->take(there.sample));
  CHECK(there.sample.payload == payload(8));
  CHECK_FALSE(there.inbox->take(there.sample));
}

TEST_CASE("shortcut: whatever is not one plain sample is the library's", "[bus]") {
  // Oracle: false, and an empty inbox: fragments, gaps, heartbeats, two samples, a sample with
  // words beside it (flag 2) or a key alone (8), discovery, a writer that was not met, one to
  // another participant of this port.
  Connected there;
  const Bytes sample = data(kUserWriter, 1, payload(7));
  const Bytes words = Bytes(sample.begin() + 4, sample.end());
  for (const Bytes& packet :
       {Bytes(), timestamp(), gap(1, 2), heartbeat(1, 2), acknack(1, 0),
        data_frag(1, 1, 1, 40, 40, payload(7)), joined({sample, heartbeat(1, 1)}),
        joined({sample, data(kUserWriter, 2, payload(8))}),
        submessage(0x15, 7, Content().raw(words)), submessage(0x15, 9, Content().raw(words)),
        announcement(kSomebody), data(kUserWriter + 0x100, 1, payload(7)),
        joined({to(kSomebody), sample}), joined({secured_word(), sample})}) {
    CHECK_FALSE(there.take(packet));
  }
  CHECK_FALSE(there.shortcut.take(joined({header(kSomebodyElse), sample}), kArrived));
  CHECK(there.waiting() == 0);
  CHECK(there.take(sample));
  CHECK(there.waiting() == 1);
}

TEST_CASE("shortcut: a sample comes once, and none after a later one", "[bus]") {
  // Oracle: RTPS 2.5, 8.4.11.2: a best-effort reader takes what is above its last number.
  Connected there;
  for (const std::int64_t number : {5, 5, 4, 6, 1}) {
    CHECK(there.take(data(kUserWriter, number, payload(7))));
  }
  CHECK(there.waiting() == 2);
}

TEST_CASE("shortcut: each reader of a writer gets what is said to it or to all", "[bus]") {
  // Oracle: counts by hand; after a reader has left, and a writer, the library is asked again.
  Connected there;
  const auto other = std::make_shared<SampleInbox>();
  there.shortcut.connect(there.writer, kOtherReader, other);
  CHECK(there.take(data_to(0, 1, payload(1))));
  CHECK(there.take(data_to(kReader, 2, payload(2))));
  CHECK(there.take(data_to(kOtherReader, 3, payload(3))));
  CHECK(there.waiting() == 2);
  CHECK(other->take(there.sample));
  CHECK(other->take(there.sample));
  CHECK_FALSE(other->take(there.sample));

  there.shortcut.disconnect(kReader);
  CHECK(there.take(data_to(0, 4, payload(4))));
  CHECK(there.waiting() == 0);
  there.shortcut.disconnect(there.writer, kOtherReader);
  CHECK_FALSE(there.take(data_to(0, 5, payload(5))));
}

TEST_CASE("shortcut: an inbox that nobody empties is bounded", "[bus]") {
  // Oracle: what was put in, up to the bound; then it takes again.
  SampleInbox inbox;
  const Bytes large(1 << 20);
  const WriterId writer = id_of(kSomebody, kUserWriter);
  for (int k = 0; k < 40; ++k) inbox.put(writer, k, large);
  RawSample sample;
  std::size_t count = 0;
  while (inbox.take(sample)) CHECK(sample.received_time_ns == std::int64_t(count++));
  CHECK(count == SampleInbox::kMostBytes / large.size());
  inbox.put(writer, 0, large);
  CHECK(inbox.take(sample));
}

TEST_CASE("shortcut: any bytes that the filter lets through are looked at within their bounds",
          "[bus]") {
  // Oracle: the sanitizers, under which this runs too; a sample is part of its packet.
  Connected there;
  std::mt19937 random(3);
  std::vector<std::uint8_t> kept;
  for (int k = 0; k < 50'000; ++k) {
    Bytes packet = joined({header(), to(kSomebodyElse), timestamp(),
                           data(kUserWriter, std::int64_t(random() % 1000), payload(0))});
    for (int flips = 0; flips < 3; ++flips) {
      packet[20 + random() % (packet.size() - 20)] = static_cast<std::uint8_t>(random());
    }
    const FilteredPacket passed = filter_packet(packet, {}, kept);
    if (!passed.packet.empty()) there.shortcut.take(passed.packet, kArrived);
    while (there.inbox->take(there.sample)) REQUIRE(there.sample.payload.size() <= packet.size());
  }
}

}  // namespace palpate::bus
