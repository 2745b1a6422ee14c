#include "modules/bus/packet_stamp.h"

#include <catch2/catch.hpp>
#include <random>

#include "modules/bus/rtps_words.h"
#include "tests/modules/bus/rtps_packets.h"

namespace palpate::bus {
namespace {

using namespace testing;

constexpr std::int64_t kSome = 1'700'000'000'123'456'789;

// What a reader makes of the eight bytes of a time, cutting what is below a nanosecond.
std::int64_t ns_at(const Bytes& bytes, std::size_t at) {
  std::uint64_t seconds = 0, fraction = 0;
  for (std::size_t i = 4; i-- > 0;) seconds = seconds << 8 | bytes[at + i];
  for (std::size_t i = 4; i-- > 0;) fraction = fraction << 8 | bytes[at + 4 + i];
  return static_cast<std::int64_t>(seconds * 1'000'000'000 + (fraction * 1'000'000'000 >> 32));
}

}  // namespace

TEST_CASE("packet stamp: every time in a packet becomes that of its arrival", "[bus]") {
  // Oracle: the nanoseconds given, for many of them; all other bytes as they were.
  const Bytes before =
      joined({header(), timestamp(), data(kUserWriter, 1, Bytes(24, 7)), timestamp()});
  const std::size_t first = header().size() + 4, second = before.size() - 8;
  std::mt19937_64 random(1);
  for (int k = 0; k < 10'000; ++k) {
    const std::int64_t time = kSome + static_cast<std::int64_t>(random() % 10'000'000'000);
    Bytes packet = before;
    stamp_arrival(packet, time);
    REQUIRE(ns_at(packet, first) == time);
    REQUIRE(ns_at(packet, second) == time);
    for (const std::size_t at : {first, second}) {
      std::copy_n(before.begin() + std::ptrdiff_t(at), 8, packet.begin() + std::ptrdiff_t(at));
    }
    REQUIRE(packet == before);
  }
}

TEST_CASE("packet stamp: a time in the other order of bytes is told in that", "[bus]") {
  // Oracle: the same bytes, turned round word by word.
  Bytes packet = joined({header(), {9, 0, 0, 8}, Bytes(8)});
  Bytes little = joined({header(), timestamp()});
  stamp_arrival(packet, kSome);
  stamp_arrival(little, kSome);
  for (const std::size_t word : {24u, 28u}) {
    std::reverse(packet.begin() + std::ptrdiff_t(word), packet.begin() + std::ptrdiff_t(word) + 4);
  }
  CHECK(ns_at(packet, 24) == kSome);
  CHECK(std::equal(packet.end() - 8, packet.end(), little.end() - 8));
}

TEST_CASE("packet stamp: a time that is not told, and what is no packet, stay", "[bus]") {
  // Oracle: identity; a time cut by the packet's end, or said to be none (flag 2), has no place.
  for (Bytes packet :
       {Bytes(), header(), joined({header(), {9, 3, 0, 0}}),
        joined({header(), {9, 1, 8, 0}, Bytes(7)}), joined({header(), {9, 1, 4, 0}, Bytes(4)}),
        joined({header(), {0x15, 1, 0, 0}, timestamp()})}) {
    const Bytes before = packet;
    stamp_arrival(packet, kSome);
    CHECK(packet == before);
  }
}

TEST_CASE("packet stamp: any bytes are looked at within their bounds", "[bus]") {
  // Oracle: the sanitizers, under which this runs too, and the size.
  std::mt19937 random(2);
  for (int k = 0; k < 20'000; ++k) {
    Bytes packet = joined({header(), timestamp(), data(kUserWriter, 1, Bytes(24)), timestamp()});
    for (int flips = 0; flips < 6; ++flips) {
      packet[20 + random() % (packet.size() - 20)] = static_cast<std::uint8_t>(random());
    }
    packet.resize(random() % packet.size());
    const std::size_t size = packet.size();
    stamp_arrival(packet, kSome);
    REQUIRE(packet.size() == size);
  }
}

}  // namespace palpate::bus
