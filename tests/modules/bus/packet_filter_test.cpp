#include "modules/bus/packet_filter.h"

#include <catch2/catch.hpp>
#include <random>

#include "tests/modules/bus/rtps_packets.h"

namespace palpate::bus {
namespace {

using namespace testing;

constexpr std::uint64_t kFilterToken = 0x1122334455667788;

/// The first fields of a sample, and some more.
Bytes sample(std::uint64_t token = kFilterToken) {
  return Content()
      .number(std::uint32_t{0x100})
      .raw(Bytes(24))
      .number(token)
      .raw(Bytes(968 - 4))
      .bytes();
}

Bytes short_of(Bytes bytes) {
  bytes.pop_back();
  return bytes;
}

struct Verdict {
  Bytes packet;
  PacketFault fault = PacketFault::kNone;
};

Verdict filtered(const Bytes& packet, bool secured = false) {
  Bytes kept;
  const FilteredPacket result = filter_packet(packet, {kFilterToken, secured}, kept);
  return {Bytes(result.packet.begin(), result.packet.end()), result.fault};
}

PacketFault fault_of(const Bytes& message, bool secured = false) {
  return filtered(joined({header(), message}), secured).fault;
}

/// One sound sub-message of each kind.
std::vector<Bytes> sound_messages() {
  return {timestamp(),
          submessage(9, 3, Content()),  // no time
          submessage(0x0e, 1, Content().raw(kSomebodyElse)),
          data(kUserWriter, 1, sample()),
          announcement(kSomebody),
          farewell(kSomebody),
          data_frag(1, 1, 1, 1000, 2500, sample()),
          data_frag(1, 3, 1, 1000, 2500, Bytes(500)),
          gap(1, 5, 33),
          gap(1, 1 + kMaxGap),
          heartbeat(1, 0),
          heartbeat(3, 9),
          acknack(0, 0),
          acknack(17, 256),
          submessage(0x12, 1,
                     Content().entity(0).entity(0).sequence(3).four(1).four(8).four(0).four(1)),
          submessage(0x13, 1, Content().entity(0).entity(0).sequence(3).four(2).four(1)),
          submessage(0x0f, 1, Content().four(1).raw(Bytes(24))),
          submessage(0x0d, 1, Content().four(1).four(2)),
          submessage(1, 1, Content())};
}

}  // namespace

TEST_CASE("packet filter: every kind of sub-message that is sound passes, bit by bit", "[bus]") {
  // Oracle: packets made by hand after the standard.
  for (const Bytes& message : sound_messages()) {
    const Bytes packet = joined({header(), timestamp(), message, timestamp()});
    const Verdict verdict = filtered(packet);
    CAPTURE(int(message[0]), int(message[1]), message.size());
    CHECK(verdict.fault == PacketFault::kNone);
    CHECK(verdict.packet == packet);
  }
}

TEST_CASE("packet filter: what vendors add is left out, and is no fault", "[bus]") {
  // Oracle: the packet without it, joined by hand.
  const Bytes one = heartbeat(1, 2), two = timestamp();
  CHECK(filtered(joined({header(), one, statistics()})).packet == joined({header(), one}));
  CHECK(filtered(joined({header(), one, statistics(), two, statistics()})).packet ==
        joined({header(), one, two}));
  CHECK(filtered(joined({header(), statistics()})).packet.empty());
  CHECK(filtered(joined({header(), statistics(), two})).fault == PacketFault::kNone);
}

TEST_CASE("packet filter: the packet that ended every process of a domain does not pass", "[bus]") {
  // Oracle: the packet's description: 84 bytes, sub-message 0x80 with four bytes too many.
  const Bytes packet = statistics_and_more();
  REQUIRE(packet.size() == 84);
  CHECK(filtered(packet).packet.empty());
}

TEST_CASE("packet filter: each rule that is broken refuses the packet and names itself", "[bus]") {
  // Oracle: one fault by hand per case, each a step beyond what passes above.
  CHECK(filtered({'R', 'T', 'P', 'S', 2}).fault == PacketFault::kHeader);
  CHECK(filtered(joined({Bytes{'R', 'T', 'P', 'X'}, Bytes(30)})).fault == PacketFault::kHeader);
  const Bytes user = sample();
  CHECK(fault_of({0x09, 1, 9, 0, 1, 2, 3, 4, 5, 6, 7, 8}) == PacketFault::kLength);
  CHECK(fault_of({0x09, 1, 4, 0, 1, 2, 3, 4}) == PacketFault::kLength);
  CHECK(fault_of({0x09, 1}) == PacketFault::kLength);
  CHECK(fault_of(submessage(0x30, 1, Content().raw(Bytes(40)))) == PacketFault::kKind);
  CHECK(fault_of(submessage(0x0c, 1, Content().raw(Bytes(20)))) == PacketFault::kKind);
  CHECK(fault_of(submessage(0x02, 1, Content())) == PacketFault::kKind);
  CHECK(fault_of(data(kUserWriter, 0, user)) == PacketFault::kSequence);
  CHECK(fault_of(data(kUserWriter, -1, user)) == PacketFault::kSequence);
  CHECK(fault_of(data(kUserWriter, 1, {0, 1})) == PacketFault::kLength);
  CHECK(fault_of(heartbeat(0, 5)) == PacketFault::kSequence);
  CHECK(fault_of(heartbeat(5, 3)) == PacketFault::kSequence);
  CHECK(fault_of(gap(0, 5)) == PacketFault::kSequence);
  CHECK(fault_of(gap(6, 5)) == PacketFault::kSequence);
  CHECK(fault_of(gap(1, 5, 257)) == PacketFault::kLength);
  CHECK(fault_of(acknack(1, 257)) == PacketFault::kLength);
  CHECK(fault_of(data_frag(1, 0, 1, 1000, 2500, sample())) == PacketFault::kFragment);
  CHECK(fault_of(data_frag(1, 4, 1, 1000, 2500, sample())) == PacketFault::kFragment);
  CHECK(fault_of(data_frag(1, 1, 1, 1000, 200'000'000, sample())) == PacketFault::kFragment);
  CHECK(fault_of(data_frag(1, 0xffffffff, 0xffff, 0xffff, 0xffff, sample())) ==
        PacketFault::kFragment);
  CHECK(fault_of(data_frag(1, 1, 1, 1000, 2500, short_of(sample()))) == PacketFault::kLength);
  CHECK(fault_of(submessage(0x0f, 1, Content().four(0xffffffff))) == PacketFault::kLength);
  const Bytes list = Content().number(std::uint32_t{0x300}).two(0x62).two(8).four(0).bytes();
  CHECK(fault_of(data(kAnnouncer, 1, list)) == PacketFault::kParameters);  // ends in a value
  CHECK(fault_of(data(kAnnouncer, 1, {0, 3, 0, 0})) == PacketFault::kParameters);
  CHECK(fault_of(data(kAnnouncer, 1, {0, 7, 0, 0})) == PacketFault::kParameters);
}

TEST_CASE("packet filter: nobody announces or buries another participant", "[bus]") {
  // Oracle: the GUID of the header against that of the words.
  CHECK(fault_of(announcement(kSomebodyElse)) == PacketFault::kIdentity);
  CHECK(fault_of(farewell(kSomebodyElse)) == PacketFault::kIdentity);
}

TEST_CASE("packet filter: samples of topics bear the token, in their first fragment at least",
          "[bus]") {
  // Oracle: the place of the token in idl/: after the encapsulation and three numbers of 8 bytes.
  const Bytes foreign = sample(kFilterToken + 1);
  CHECK(fault_of(data(kUserWriter, 1, foreign)) == PacketFault::kToken);
  CHECK(fault_of(data_frag(1, 1, 1, 1000, 2500, foreign)) == PacketFault::kToken);
  CHECK(fault_of(data_frag(1, 2, 1, 1000, 2500, foreign)) == PacketFault::kNone);  // no token there
  Bytes big_endian = foreign;
  big_endian[1] = 0;
  for (int k = 0; k < 8; ++k) {
    big_endian[std::size_t(28 + k)] = static_cast<std::uint8_t>(kFilterToken >> 8 * (7 - k));
  }
  CHECK(fault_of(data(kUserWriter, 1, big_endian)) == PacketFault::kNone);
  const Bytes whole = sample();
  CHECK(fault_of(data(kUserWriter, 1, Bytes(whole.begin(), whole.begin() + 35))) ==
        PacketFault::kToken);
  CHECK(fault_of(data_frag(1, 1, 1, 35, 2500, Bytes(whole.begin(), whole.begin() + 35))) ==
        PacketFault::kToken);
  CHECK(fault_of(joined({timestamp(), data(kUserWriter, 1, foreign)})) == PacketFault::kToken);
}

TEST_CASE("packet filter: with keys, words on topics come encrypted or not at all", "[bus]") {
  // Oracle: DDS Security 1.1, section 7.3.6: sizes of prefix and postfix; discovery stays plain.
  for (const Bytes& words :
       {data(kUserWriter, 1, sample()), data_frag(1, 1, 1, 1000, 2500, sample()), gap(1, 5),
        heartbeat(1, 2), acknack(1, 1)}) {
    CHECK(fault_of(words, true) == PacketFault::kPlain);
    CHECK(fault_of(words, false) == PacketFault::kNone);
  }
  CHECK(fault_of(announcement(kSomebody), true) == PacketFault::kNone);
  const Bytes word = secured_word();
  const Bytes sound = joined({header(), timestamp(), word, word});
  CHECK(filtered(sound, true).packet == sound);
  CHECK(filtered(sound, false).fault == PacketFault::kKind);
  CHECK(fault_of(short_of(word), true) == PacketFault::kLength);
  CHECK(fault_of(Bytes(word.begin() + 24, word.end()), true) == PacketFault::kSecured);
  CHECK(fault_of(Bytes(word.begin(), word.end() - 24), true) == PacketFault::kSecured);
  CHECK(fault_of(submessage(0x33, 1, Content().raw(Bytes(100))), true) ==
        PacketFault::kKind);  // whole packets: nobody of ours
}

TEST_CASE("packet filter: the end of a key is left out, and is no fault", "[bus]") {
  // Oracle: the packet without it. It would take the place of the key's newest sample.
  const auto ends_key = [](std::uint32_t writer) {
    return submessage(0x15, 11,
                      Content()
                          .two(0)
                          .two(16)
                          .entity(0)
                          .entity(writer)
                          .sequence(1)
                          .two(0x71)
                          .two(4)
                          .raw({0, 0, 0, 1})
                          .two(1)
                          .two(0)
                          .four(0x100)
                          .four(7));
  };
  const Verdict verdict = filtered(joined({header(), timestamp(), ends_key(kUserWriter)}));
  CHECK(verdict.packet == joined({header(), timestamp()}));
  CHECK(verdict.fault == PacketFault::kNone);
}

TEST_CASE("packet filter: a gap too wide is left out alone, and counts", "[bus]") {
  // Oracle: the packet without it, joined by hand.
  const Bytes one = timestamp(), two = heartbeat(1, 2);
  const Verdict verdict = filtered(joined({header(), one, gap(1, 2 + kMaxGap), two}));
  CHECK(verdict.packet == joined({header(), one, two}));
  CHECK(verdict.fault == PacketFault::kGap);
  CHECK(filtered(joined({header(), gap(1, std::int64_t{1} << 62)})).packet.empty());
}

TEST_CASE("packet filter: cut anywhere, a packet never gives a part of a sub-message", "[bus]") {
  // Oracle: invariant: what passes ends where a sub-message of the whole packet ends. Sanitizers
  // tell reads beyond the end.
  Bytes packet = header();
  std::vector<std::size_t> ends{0, packet.size()};
  for (const Bytes& message : sound_messages()) {
    packet = joined({packet, message});
    ends.push_back(packet.size());
  }
  REQUIRE(filtered(packet).packet == packet);
  for (std::size_t size = 0; size < packet.size(); ++size) {
    const Verdict verdict = filtered(Bytes(packet.begin(), packet.begin() + std::ptrdiff_t(size)));
    const bool whole = std::find(ends.begin(), ends.end(), verdict.packet.size()) != ends.end();
    CAPTURE(size, verdict.packet.size());
    CHECK(whole);
    CHECK((verdict.packet.empty() || verdict.packet.size() == size));
  }
}

TEST_CASE("packet filter: whatever passes passes again unchanged", "[bus]") {
  // Oracle: invariant (idempotence) over a hundred thousand changed packets; sanitizers tell reads
  // beyond the end. Some must pass and some must not, or it proves nothing.
  std::mt19937 random(1);
  const std::vector<Bytes> sound = sound_messages();
  std::size_t passed = 0, refused = 0;
  for (int round = 0; round < 100'000; ++round) {
    Bytes packet = header();
    for (int k = 0; k < 3; ++k) packet = joined({packet, sound[random() % sound.size()]});
    for (std::uint32_t k = random() % 4; k > 0; --k) {
      packet[20 + random() % (packet.size() - 20)] = static_cast<std::uint8_t>(random());
    }
    const Verdict once = filtered(packet);
    ++(once.packet.empty() ? refused : passed);
    if (once.packet.empty()) continue;
    const Verdict twice = filtered(once.packet);
    REQUIRE(twice.packet == once.packet);
    REQUIRE(twice.fault == PacketFault::kNone);
  }
  CHECK(passed > 10'000);
  CHECK(refused > 10'000);
}

TEST_CASE("packet filter: every fault has a text of its own", "[bus]") {
  // Oracle: no two equal.
  std::vector<std::string> texts;
  for (int fault = 0; fault <= int(PacketFault::kPlain); ++fault) {
    texts.emplace_back(text_of(PacketFault(fault)));
  }
  std::sort(texts.begin(), texts.end());
  CHECK(std::adjacent_find(texts.begin(), texts.end()) == texts.end());
}

}  // namespace palpate::bus
