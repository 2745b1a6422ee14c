#include "modules/bus/packet_senders.h"

#include <catch2/catch.hpp>

namespace palpate::bus {
namespace {

GuidPrefix participant(int number) {
  GuidPrefix prefix{};
  prefix[0] = static_cast<std::uint8_t>(number);
  prefix[1] = static_cast<std::uint8_t>(number >> 8);
  return prefix;
}

PacketSender sender(int port) { return {0x7f000001, static_cast<std::uint16_t>(port)}; }

}  // namespace

TEST_CASE("packet senders: a participant is who was first heard to be it, for ever", "[bus]") {
  // Oracle: the rule, case by case.
  PacketSenders senders;
  const std::int64_t later = 100 * PacketSenders::kForgotten;
  CHECK(senders.admit(participant(1), sender(10), 0));
  CHECK_FALSE(senders.admit(participant(1), sender(11), 1));
  CHECK_FALSE(senders.admit(participant(1), {0x0a000001, 10}, 1));
  CHECK_FALSE(senders.admit(participant(1), sender(11), later));
  CHECK(senders.admit(participant(1), sender(10), later));
}

TEST_CASE("packet senders: a port speaks for one, and for another when that is silent", "[bus]") {
  // Oracle: the rule, case by case.
  PacketSenders senders;
  const std::int64_t silence = PacketSenders::kSilence;
  CHECK(senders.admit(participant(1), sender(10), 0));
  CHECK_FALSE(senders.admit(participant(2), sender(10), silence - 1));
  CHECK(senders.admit(participant(2), sender(10), silence));
  CHECK_FALSE(senders.admit(participant(1), sender(10), silence + 1));  // it has left
  CHECK(senders.admit(participant(2), sender(10), silence + 2));
}

TEST_CASE("packet senders: a crowd of strangers does not push out who speaks", "[bus]") {
  // Oracle: the bound that it documents; strangers make room only when forgotten.
  PacketSenders senders;
  CHECK(senders.admit(participant(0), sender(1), 0));
  const auto crowd = static_cast<int>(PacketSenders::kMaxParticipants);
  for (int k = 1; k < 2 * crowd; ++k) {
    CHECK(senders.admit(participant(k), sender(1 + k), k) == (k < crowd));
  }
  const std::int64_t forgotten = PacketSenders::kForgotten + crowd;
  CHECK(senders.admit(participant(0), sender(1), forgotten));
  CHECK(senders.admit(participant(3000), sender(3000), forgotten));  // in the place of 1
  CHECK(senders.admit(participant(0), sender(1), forgotten + 1));
  CHECK(senders.admit(participant(2), sender(3), forgotten + 1));
}

}  // namespace palpate::bus
