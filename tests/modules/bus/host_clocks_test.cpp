#include "modules/bus/host_clocks.h"

#include <catch2/catch.hpp>
#include <memory>

namespace palpate::bus {
namespace {

constexpr std::int64_t kOneSec = 1'000'000'000;

WriterId writer_of(unsigned char participant, unsigned char endpoint = 1) {
  WriterId id{};
  id[0] = participant;
  id[15] = endpoint;
  return id;
}

/// Participants below 100 are of this host.
std::unique_ptr<HostClocks> some_clocks() {
  return std::make_unique<HostClocks>([](const GuidPrefix& participant) {
    return participant[0] < 100 ? std::string() : "10.0.0." + std::to_string(participant[0]);
  });
}

}  // namespace

TEST_CASE("host clocks: of this host the clock is known, its offset and error exactly zero",
          "[bus]") {
  // Oracle: one clock. What an exchange says of such a participant changes nothing.
  const auto table = some_clocks();
  const auto own = table->of(writer_of(3), 5 * kOneSec);
  CHECK(own.known);
  CHECK(own.shift_ns == 0);
  CHECK(own.error == 0);
  table->set(participant_of(writer_of(3)), {77, 0.5}, 0, 5 * kOneSec);
  CHECK(table->of(writer_of(3), 6 * kOneSec).shift_ns == 0);
}

TEST_CASE("host clocks: another host's is unknown until it is set, for all its endpoints",
          "[bus]") {
  // Oracle: the rule; the error grows by ClockOffset::kMostDrift.
  const auto table = some_clocks();
  CHECK_FALSE(table->of(writer_of(200, 1), kOneSec).known);
  table->set(participant_of(writer_of(200, 9)), {-42, 0.002}, 0, 10 * kOneSec);
  const auto known = table->of(writer_of(200, 2), 15 * kOneSec);
  CHECK(known.known);
  CHECK(known.shift_ns == -42);
  CHECK(known.error == Approx(0.002 + 5 * ClockOffset::kMostDrift));
  CHECK_FALSE(table->of(writer_of(201), kOneSec).known);
}

TEST_CASE("host clocks: a clock that is missed is named, with patience, until it is known",
          "[bus]") {
  // Oracle: kPatience, kForgotten.
  const auto table = some_clocks();
  CHECK(std::string(table->trouble(kOneSec)).empty());
  table->missed(writer_of(200), 10 * kOneSec);
  CHECK(std::string(table->trouble(11 * kOneSec)).empty());
  table->missed(writer_of(200), 12 * kOneSec);
  CHECK(std::string(table->trouble(12 * kOneSec + 1)).find("10.0.0.200") != std::string::npos);
  CHECK(std::string(table->trouble(16 * kOneSec)).empty());  // nothing came from there since
  table->missed(writer_of(200), 16 * kOneSec);
  table->set(participant_of(writer_of(200)), {1, 0.1}, 0, 16 * kOneSec);
  CHECK(std::string(table->trouble(16 * kOneSec)).empty());
}

TEST_CASE("host clocks: one that was set anew is named for a while", "[bus]") {
  // Oracle: kJumpShown.
  const auto table = some_clocks();
  table->set(participant_of(writer_of(200)), {1, 0.1}, 0, kOneSec);
  CHECK(std::string(table->trouble(kOneSec)).empty());
  table->set(participant_of(writer_of(200)), {9, 0.1}, 1, 2 * kOneSec);
  CHECK(std::string(table->trouble(3 * kOneSec)).find("10.0.0.200") != std::string::npos);
  CHECK(std::string(table->trouble(8 * kOneSec)).empty());
}

TEST_CASE("host clocks: more participants than there is room for stay unknown", "[bus]") {
  // Oracle: kMostParticipants.
  const auto table = some_clocks();
  WriterId id = writer_of(200);
  for (std::size_t i = 0; i < HostClocks::kMostParticipants + 10; ++i) {
    id[1] = static_cast<unsigned char>(i);
    id[2] = static_cast<unsigned char>(i >> 8);
    CHECK_FALSE(table->of(id, kOneSec).known);
  }
}

}  // namespace palpate::bus
