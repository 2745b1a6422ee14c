#include "modules/messages/cdr.h"

#include <catch2/catch.hpp>
#include <functional>
#include <limits>

#include "tests/modules/messages/generated_code.h"

namespace palpate::messages {
namespace {

using testing::payload_of;
using testing::Random;
using testing::random_message;

constexpr int kRounds = 200;

template <class Message>
void check_round_trip() {
  CAPTURE(type_of<Message>().name);
  Random random(11);
  std::vector<std::uint8_t> payload;
  Message decoded;  // serves every round, so leftovers of the last would show
  for (int round = 0; round < kRounds; ++round) {
    auto message = random_message<Message>(random);
    message.header.session_token = random();
    REQUIRE(encode(message, payload) == nullptr);
    REQUIRE(decode(payload, decoded) == nullptr);
    testing::check_same(testing::generated(payload, message), decoded);
  }
}

template <class Message>
void check_against_generated_code() {
  CAPTURE(type_of<Message>().name);
  Random random(12);
  for (int round = 0; round < kRounds; ++round) {
    auto message = random_message<Message>(random);
    message.header.session_token = random();
    const auto ours = payload_of(message);
    auto wire = testing::generated(ours, message);
    testing::check_same(wire, message);
    REQUIRE(testing::serialized(wire, testing::kLittleEndian) == ours);
    Message decoded;
    REQUIRE(decode(testing::serialized(wire, testing::kBigEndian), decoded) == nullptr);
    testing::check_same(wire, decoded);
  }
}

// Every prefix of a payload, and every payload with a byte changed, is read or refused.
template <class Message>
void check_survives_any_bytes() {
  CAPTURE(type_of<Message>().name);
  Random random(13);
  Message decoded;
  for (int round = 0; round < 20; ++round) {
    const auto payload = payload_of(random_message<Message>(random));
    for (std::size_t size = 0; size < payload.size(); ++size) {
      REQUIRE(decode(Payload(payload).first(size), decoded) != nullptr);
    }
    for (int change = 0; change < 500; ++change) {
      auto changed = payload;
      for (int k = 0; k < 3; ++k) {
        changed[testing::whole(random, 0, changed.size() - 1)] =
            static_cast<std::uint8_t>(random());
      }
      if (decode(changed, decoded) == nullptr) REQUIRE(payload_of(decoded).size() > 4);
      key_of(type_of<Message>(), changed);
    }
  }
}

template <class Message>
std::string refused(const std::function<void(std::vector<std::uint8_t>&)>& corrupt) {
  Random random(14);
  auto payload = payload_of(random_message<Message>(random));
  corrupt(payload);
  Message decoded;
  const char* field = decode(payload, decoded);
  return field == nullptr ? "accepted" : field;
}

}  // namespace

TEST_CASE("cdr: decoding what was encoded gives the same message, bit by bit", "[messages]") {
  // Oracle: the code generated from idl/, each member compared by hand-written names.
#define PALPATE_CHECK(Message) check_round_trip<Message>();
  PALPATE_MESSAGES(PALPATE_CHECK)
#undef PALPATE_CHECK
}

TEST_CASE("cdr: bytes are those of the code generated from idl/, in both byte orders",
          "[messages]") {
  // Oracle: fastddsgen's code and Fast CDR.
#define PALPATE_CHECK(Message) check_against_generated_code<Message>();
  PALPATE_MESSAGES(PALPATE_CHECK)
#undef PALPATE_CHECK
}

TEST_CASE("cdr: keys are those of the generated code", "[messages]") {
  // Oracle: fastddsgen's getKey, forced to hash or not.
#define PALPATE_CHECK(Message) testing::check_keys<Message>();
  PALPATE_MESSAGES(PALPATE_CHECK)
#undef PALPATE_CHECK
}

TEST_CASE("cdr: any bytes are read or refused", "[messages]") {
  // Oracle: no crash, no exception; a prefix without the last fields is never whole.
#define PALPATE_CHECK(Message) check_survives_any_bytes<Message>();
  PALPATE_MESSAGES(PALPATE_CHECK)
#undef PALPATE_CHECK
}

TEST_CASE("cdr: up to three bytes of padding may follow, no more", "[messages]") {
  // Oracle: RTPS pads payloads to whole words.
  for (const std::size_t bytes : {1u, 2u, 3u, 4u, 40u}) {
    const std::string expected = bytes <= 3 ? "accepted" : "payload";
    CHECK(refused<ProbeState>([&](auto& p) { p.resize(p.size() + bytes); }) == expected);
  }
}

TEST_CASE("cdr: encapsulations other than plain CDR are refused", "[messages]") {
  // Oracle: the identifiers of the RTPS specification: 0 and 1 are plain CDR.
  for (const std::uint8_t kind : {2, 3, 6, 7, 8, 9}) {
    CHECK(refused<SessionControl>([&](auto& p) { p[1] = kind; }) == "payload");
  }
  CHECK(refused<SessionControl>([](auto& p) { p[0] = 1; }) == "payload");
}

TEST_CASE("cdr: lists longer than their bound or the payload are refused before they are made",
          "[messages]") {
  // Oracle: the bounds of idl/README.md. The count of node positions is at 4 + 84 − 4 bytes.
  const auto with_count = [](std::uint32_t count, std::size_t floats) {
    NodePositions message;
    message.header.sequence = 1;
    message.positions.resize(3);
    auto payload = payload_of(message);
    const std::size_t place = payload.size() - 3 * sizeof(float) - sizeof count;
    std::memcpy(payload.data() + place, &count, sizeof count);
    payload.resize(place + sizeof count + floats * sizeof(float));
    NodePositions decoded;
    const char* field = decode(payload, decoded);
    CHECK(decoded.positions.capacity() <= floats);
    return std::string(field == nullptr ? "accepted" : field);
  };
  CHECK(with_count(3, 3) == "accepted");
  CHECK(with_count(~0u, 3) == "payload");
  CHECK(with_count(6, 3) == "payload");
  CHECK(with_count(4, 4) == "positions_m");
  CHECK(with_count(0, 0) == "positions_m");
  CHECK(with_count(3 * kMaxNodes + 3, 3 * kMaxNodes + 3) == "positions_m");
}

TEST_CASE("cdr: words and flags that do not exist are refused by name, also beyond a byte",
          "[messages]") {
  // Oracle: idl/; 256 would be 0 if narrowed first. A command lies after the header.
  for (const std::uint32_t value : {5u, 256u, ~0u}) {
    CHECK(refused<SessionControl>([&](auto& p) { std::memcpy(&p[36], &value, 4); }) == "command");
  }
}

TEST_CASE("cdr: a message that breaks a rule is not encoded", "[messages]") {
  // Oracle: the rule's field name; that every rule is looked at is tested with the checks.
  ProbeState state;
  state.header.sequence = 1;
  state.pose.position.z() = std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> payload;
  CHECK(std::string(encode(state, payload)) == "position_m");
}

TEST_CASE("cdr: quaternions go x, y, z, w and matrices row by row", "[messages]") {
  // Oracle: the wire specification (idl/), read by the generated code.
  ProbeState state;
  state.header.sequence = 1;
  state.pose.rotation = Quat(0.5, -0.5, 0.5, -0.5);  // w first
  CHECK(testing::generated(payload_of(state), state).rotation_xyzw() ==
        std::array<double, 4>{-0.5, 0.5, -0.5, 0.5});
  ContactModel model;
  model.header.sequence = 1;
  model.stiffness << 4, 1e-7, 0, 0, 5, 0, 0, 0, 6;  // asymmetric within the tolerance
  CHECK(testing::generated(payload_of(model), model).stiffness_n_per_m() ==
        std::array<double, 9>{4, 1e-7, 0, 0, 5, 0, 0, 0, 6});
}

TEST_CASE("cdr: the header is read in both byte orders without the rest", "[messages]") {
  // Oracle: bytes written by hand; CDR says its order in its second byte.
  std::vector<std::uint8_t> little(36), big(36);
  little[1] = 1;
  for (std::size_t field = 0; field < 4; ++field) {
    little[4 + 8 * field] = big[4 + 8 * field + 7] = static_cast<std::uint8_t>(field + 1);
    little[5 + 8 * field] = big[4 + 8 * field + 6] = 1;
  }
  for (const auto& payload : {little, big}) {
    const Header header = header_of(payload);
    CHECK(header.sequence == 257);
    CHECK(header.sim_time_ns == 258);
    CHECK(header.source_time_ns == 259);
    CHECK(header.session_token == 260);
    CHECK(token_of(payload) == 260);
  }
  little.pop_back();
  CHECK(header_of(little).sequence == 0);
  CHECK_FALSE(token_of(little).has_value());
}

TEST_CASE(
    "cdr: token and sequence number are written in a payload's own byte order, and nothing else",
    "[messages]") {
  // Oracle: the payload with another token, written as a whole by the generated code.
  Random random(17);
  auto message = random_message<HapticForce>(random);
  message.header.session_token = 0x1122334455667788;
  message.header.sequence = 0x99aabbccddeeff01;
  const auto ours = payload_of(message);
  const auto wire = testing::generated(ours, message);
  message.header.session_token = 5;
  message.header.sequence = 6;
  const auto other = testing::generated(payload_of(message), message);
  for (const auto order : {testing::kLittleEndian, testing::kBigEndian}) {
    auto payload = testing::serialized(other, order);
    set_token(payload, 0x1122334455667788);
    set_sequence(payload, 0x99aabbccddeeff01);
    CHECK(payload == testing::serialized(wire, order));
  }
  std::vector<std::uint8_t> cut(35, 7);
  set_token(cut, 1);
  set_sequence(cut, 1);
  CHECK(cut == std::vector<std::uint8_t>(35, 7));
}

TEST_CASE("cdr: times are put on another clock, in either byte order, and nothing else",
          "[messages]") {
  // Oracle: the message with other times, written as a whole by the generated code. A big-endian
  // command comes out little-endian: it is read and written anew.
  constexpr std::int64_t kAhead = 100'000'000'000'000;
  Random random(18);
  auto force = random_message<HapticForce>(random);
  force.header.source_time_ns = 5'000;
  const auto before = testing::generated(payload_of(force), force);
  force.header.source_time_ns = 5'000 + kAhead;
  const auto after = testing::generated(payload_of(force), force);
  for (const auto order : {testing::kLittleEndian, testing::kBigEndian}) {
    auto payload = testing::serialized(before, order);
    shift_times(type_of<HapticForce>(), kAhead, payload);
    CHECK(payload == testing::serialized(after, order));
    shift_times(type_of<HapticForce>(), -2 * kAhead, payload);
    CHECK(header_of(payload).source_time_ns == 1);  // 0 would say that there is none
  }

  SessionControl control;
  control.header = {1, 2, 3'000, 4};
  control.start_time_ns = -70;
  control.until_ns = 9;
  auto payload =
      testing::serialized(testing::generated(payload_of(control), control), testing::kBigEndian);
  shift_times(type_of<SessionControl>(), kAhead, payload);
  SessionControl shifted;
  REQUIRE(decode(payload, shifted) == nullptr);
  CHECK(shifted.header.source_time_ns == 3'000 + kAhead);
  CHECK(shifted.start_time_ns == kAhead - 70);
  CHECK(shifted.until_ns == 9);
  CHECK(shifted.header.session_token == 4);

  std::vector<std::uint8_t> cut(20, 7);
  shift_times(type_of<HapticForce>(), 1, cut);
  CHECK(cut == std::vector<std::uint8_t>(20, 7));
}

TEST_CASE("cdr: times that no codec takes stay on their clock, and are refused there",
          "[messages]") {
  // Oracle: the bytes before, and the codec. 2^63 - 1 and a second more came out as 1 ns, a time.
  using Limits = std::numeric_limits<std::int64_t>;
  constexpr std::int64_t kAhead = 1'000'000'000;
  HapticForce force;
  force.header = {1, 2, 0, 0};
  for (const std::int64_t absurd : {Limits::max(), Limits::min(), kMaxTimeNs + 1}) {
    force.header.source_time_ns = absurd;
    std::vector<std::uint8_t> payload;
    write_payload(force, payload);
    const auto before = payload;
    for (const std::int64_t shift_ns : {kAhead, -kAhead}) {
      shift_times(type_of<HapticForce>(), shift_ns, payload);
      REQUIRE(payload == before);
    }
    CHECK(decode(payload, force) == std::string("source_time_ns"));
  }

  SessionControl control;
  control.header = {1, 2, 3'000, 4};
  control.start_time_ns = Limits::max();
  std::vector<std::uint8_t> payload;
  write_payload(control, payload);
  const auto before = payload;
  shift_times(type_of<SessionControl>(), Limits::max(), payload);
  REQUIRE(payload == before);
  shift_times(type_of<SessionControl>(), kAhead, payload);
  CHECK(header_of(payload).source_time_ns == 3'000 + kAhead);
  CHECK(decode(payload, control) == std::string("start_time_ns"));
}

}  // namespace palpate::messages
