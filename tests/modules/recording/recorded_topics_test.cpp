#include "modules/recording/recorded_topics.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/modules/bus/random_messages.h"
#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

template <class Message>
void check_decode(const bus::TopicOf<Message>& topic, bus::testing::Random& random) {
  CAPTURE(topic.name);
  const auto message = bus::testing::random_message<Message>(random);
  const RecordedTopic* recorded = find_recorded_topic(topic.name);
  REQUIRE(recorded != nullptr);
  CHECK(recorded->delivery == topic.delivery);
  const auto payload = cdr_of(message);
  AnyMessage decoded;
  REQUIRE(recorded->decode(payload, decoded) == nullptr);
  REQUIRE(std::holds_alternative<Message>(decoded));
  CHECK(bus::testing::equal(std::get<Message>(decoded), message));

  const Header header = header_of(payload);
  CHECK(header.sequence == message.header.sequence);
  CHECK(header.sim_time_ns == message.header.sim_time_ns);
  CHECK(header.source_time_ns == message.header.source_time_ns);
}

}  // namespace

TEST_CASE("recorded topics: every topic decodes what its wire type encodes") {
  // Oracle: round trip of random valid messages.
  bus::testing::Random random(7);
  check_decode(bus::kScene, random);
  check_decode(bus::kSurface, random);
  check_decode(bus::kNodePositions, random);
  check_decode(bus::kProbeState, random);
  check_decode(bus::kProbeInput, random);
  check_decode(bus::kContacts, random);
  check_decode(bus::kContactModel, random);
  check_decode(bus::kHapticForce, random);
  check_decode(bus::kModuleStatus, random);
  check_decode(bus::kSessionControl, random);
  CHECK(recorded_topics().size() == 10);
}

TEST_CASE("recorded topics: each carries the text of its IDL file") {
  // Oracle: the files themselves, and the type each defines.
  for (const RecordedTopic& topic : recorded_topics()) {
    const std::string type(topic.type_name.substr(topic.type_name.rfind(':') + 1));
    CAPTURE(type);
    const auto file = std::filesystem::path(PALPATE_SOURCE_DIR) / "idl" / (type + ".idl");
    CHECK(text_of(file) == topic.idl_text);
    CHECK(topic.idl_text.find("struct " + type) != std::string_view::npos);
  }
}

TEST_CASE("recorded topics: unknown names give nothing") {
  // Oracle: invariant.
  CHECK(find_recorded_topic("probe") == nullptr);
  CHECK(find_recorded_topic("") == nullptr);
}

TEST_CASE("recorded topics: malformed payloads are named, at any length") {
  // Oracle: a prefix of CDR without its last fields cannot be a whole sample.
  bus::testing::Random random(8);
  AnyMessage decoded;
  const auto check_prefixes = [&](const auto& topic, const std::vector<std::uint8_t>& payload) {
    for (std::size_t size = 0; size < payload.size(); ++size) {
      const std::span prefix(payload.data(), size);
      REQUIRE(find_recorded_topic(topic.name)->decode(prefix, decoded) == std::string("payload"));
    }
  };
  check_prefixes(bus::kProbeState, cdr_of(probe_state(1, 0, 0, Vec3::Zero())));
  check_prefixes(bus::kNodePositions, cdr_of(node_positions(1, 1e-3, 10)));
}

TEST_CASE("recorded topics: a value out of range is named by its field") {
  // Oracle: the wire name in idl/NodePositions.idl. Volume lies behind sequence, two times, organ
  // and generation: 4 + 3 · 8 + 2 · 4 = 36.
  auto payload = cdr_of(node_positions(1, 1e-3, 10));
  std::fill_n(payload.begin() + 36, 8, std::uint8_t{0xFF});  // NaN
  AnyMessage decoded;
  CHECK(find_recorded_topic("node_positions")->decode(payload, decoded) ==
        std::string("volume_m3"));
}

TEST_CASE("recorded topics: the header is read in both byte orders") {
  // Oracle: bytes written by hand; CDR says its order in its second byte.
  std::vector<std::uint8_t> little(28), big(28);
  little[1] = 1;
  for (std::size_t field = 0; field < 3; ++field) {
    little[4 + 8 * field] = big[4 + 8 * field + 7] = static_cast<std::uint8_t>(field + 1);
    little[5 + 8 * field] = big[4 + 8 * field + 6] = 1;
  }
  for (const auto& payload : {little, big}) {
    const Header header = header_of(payload);
    CHECK(header.sequence == 257);
    CHECK(header.sim_time_ns == 258);
    CHECK(header.source_time_ns == 259);
  }
  little.pop_back();
  CHECK(header_of(little).sequence == 0);
}

TEST_CASE("recorded topics: IDL texts are the same if only comments and spaces differ") {
  // Oracle: pairs judged by eye.
  CHECK(same_idl("struct A { double x; };", "// about A\nstruct A {\n  double x;  // [m]\n};\n"));
  CHECK(same_idl("", "  // nothing"));
  CHECK_FALSE(same_idl("struct A { double x; };", "struct A { float x; };"));
  CHECK_FALSE(same_idl("struct A { double x; };", "struct A { double x; double y; };"));
  CHECK_FALSE(same_idl("unsigned long x;", "unsignedlong x;"));
}

}  // namespace palpate::recording
