// The haptic loop may not allocate: counts operator new in the calling thread.
#include <catch2/catch.hpp>

#include "modules/bus/memory_bus.h"
#include "tests/counted_allocations.h"
#include "tests/modules/bus/loopback.h"
#include "tests/modules/messages/random_messages.h"

namespace palpate::bus {
namespace {

using messages::testing::Random;
using messages::testing::random_message;
using palpate::testing::allocations;
using testing::Pair;
using testing::take_soon;

struct Allocations {
  std::size_t in_write = 0, in_take = 0;
};

// Sends the same message again and again; counts after the first half.
template <class Message>
Allocations count_allocations(Writer<Message>& writer, Reader<Message>& reader) {
  Random random(31);
  auto sent = random_message<Message>(random);
  Message received;
  Allocations counted;
  constexpr int kRounds = 100;
  for (int round = 0; round < kRounds; ++round) {
    std::size_t before = allocations();
    const bool written = writer.write(sent);
    const std::size_t in_write = allocations() - before;
    const bool arrived = reader.wait(testing::kDeadline);
    before = allocations();
    const bool taken = reader.take(received);
    const std::size_t in_take = allocations() - before;
    REQUIRE((written && arrived && taken));
    if (round < kRounds / 2) continue;
    counted.in_write += in_write;
    counted.in_take += in_take;
  }
  return counted;
}

template <class Message>
void check_no_allocation(const TopicOf<Message>& topic) {
  CAPTURE(topic.name);
  Pair<Message> pair(topic);
  REQUIRE(pair.matched);
  const Allocations between_processes = count_allocations(pair.writer, pair.reader);
  CHECK(between_processes.in_write == 0);
  CHECK(between_processes.in_take == 0);

  MemoryBus memory(true);
  auto writer = memory.writer(topic);
  auto reader = memory.reader(topic);
  reader.input().set_horizon(Input::kNoHorizon);  // the way of a lockstep
  const Allocations in_memory = count_allocations(writer, reader);
  CHECK(in_memory.in_write == 0);
  CHECK(in_memory.in_take == 0);
}

}  // namespace

TEST_CASE("bus: the counter of allocations counts", "[bus]") {
  // Oracle: one allocation made by hand.
  const std::size_t before = allocations();
  const auto memory = std::make_unique<int>(1);
  CHECK(allocations() - before == 1);
  CHECK(*memory == 1);
}

TEST_CASE("bus: streams are written and taken without allocation after warm-up", "[bus]") {
  // Oracle: the count of operator new in the calling thread.
  check_no_allocation(kProbeState);
  check_no_allocation(kHapticForce);
  check_no_allocation(kContactModel);
  check_no_allocation(kContacts);
  check_no_allocation(kNodePositions);
}

}  // namespace palpate::bus
