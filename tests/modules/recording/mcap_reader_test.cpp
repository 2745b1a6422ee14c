#include "modules/recording/mcap_reader.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "tests/modules/recording/mcap_sample_file.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

constexpr int kMessages = 7;

struct Contents {
  std::vector<McapSchema> schemas;
  std::vector<McapChannel> channels;
  std::vector<McapMessage> messages;
  std::vector<McapMetadata> metadata;
  bool torn = false;
  std::uint64_t end_offset = 0;
  std::size_t records() const {
    return schemas.size() + channels.size() + messages.size() + metadata.size();
  }
};

Contents read_all(const std::filesystem::path& file) {
  McapReader reader(file);
  Contents contents;
  while (const auto record = reader.next()) {
    if (const auto* schema = std::get_if<McapSchema>(&*record)) contents.schemas.push_back(*schema);
    if (const auto* channel = std::get_if<McapChannel>(&*record)) {
      contents.channels.push_back(*channel);
    }
    if (const auto* message = std::get_if<McapMessage>(&*record)) {
      contents.messages.push_back(*message);
    }
    if (const auto* entry = std::get_if<McapMetadata>(&*record))
      contents.metadata.push_back(*entry);
  }
  contents.torn = reader.torn();
  contents.end_offset = reader.offset();
  return contents;
}

}  // namespace

TEST_CASE("mcap reader: reads back what the writer was given") {
  // Oracle: round trip — the values given to the writer in write_sample_file().
  const ScratchFolder folder;
  write_sample_file(folder / "a.mcap", kMessages);
  const Contents contents = read_all(folder / "a.mcap");
  CHECK_FALSE(contents.torn);
  REQUIRE(contents.schemas.size() == 2);
  CHECK(contents.schemas[1].name == "Pose");
  CHECK(contents.schemas[1].encoding == "omgidl");
  CHECK(contents.schemas[1].data == "struct Pose { double x; };");
  REQUIRE(contents.channels.size() == 2);
  CHECK(contents.channels[1].topic == "probe_state");
  CHECK(contents.channels[1].message_encoding == "cdr");
  CHECK(contents.channels[1].schema_id == contents.schemas[1].id);
  CHECK(contents.channels[1].metadata == McapMap{{"key", "probe"}});
  REQUIRE(contents.metadata.size() == 1);
  CHECK(contents.metadata[0].entries == McapMap{{"name", "bench"}, {"clock", "monotonic"}});
  REQUIRE(contents.messages.size() == kMessages);
  for (std::size_t i = 0; i < kMessages; ++i) {
    const McapMessage& message = contents.messages[i];
    CHECK(message.channel_id == contents.channels[i % 3 == 0 ? 1 : 0].id);
    CHECK(message.sequence == i + 1);
    CHECK(message.log_time_ns == 1'000'000 * (i + 1));
    CHECK(message.publish_time_ns == 999'000 * (i + 1));
    CHECK(message.data == std::vector<std::uint8_t>(i, std::uint8_t(0xA0 + i)));
  }
}

TEST_CASE("mcap reader: gives the header and the summary's statistics") {
  // Oracle: round trip with the writer; counts by hand.
  const ScratchFolder folder;
  write_sample_file(folder / "a.mcap", kMessages);
  McapReader reader(folder / "a.mcap");
  CHECK(reader.header().library == "palpate");
  while (reader.next()) {
  }
  REQUIRE(reader.statistics());
  CHECK(reader.statistics()->message_count == kMessages);
  CHECK(reader.statistics()->schema_count == 2);
  CHECK(reader.statistics()->channel_count == 2);
  CHECK(reader.statistics()->metadata_count == 1);
  CHECK(reader.statistics()->message_end_time_ns == 7'000'000);
  CHECK(reader.statistics()->channel_message_counts ==
        std::map<std::uint16_t, std::uint64_t>{{1, 4}, {2, 3}});
  CHECK(reader.offset() == reader.file_bytes());
}

TEST_CASE("mcap reader: a file cut at any byte opens up to its last whole record") {
  // Oracle: the record ends noted by the writer; everything before the cut must be there.
  const ScratchFolder folder;
  const auto ends = write_sample_file(folder / "whole.mcap", kMessages);
  const auto bytes = bytes_of(folder / "whole.mcap");
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
    write_bytes(folder / "cut.mcap", {bytes.begin(), bytes.begin() + std::ptrdiff_t(cut)});
    CAPTURE(cut);
    if (cut < kMcapMagic.size()) {
      CHECK_THROWS_AS(McapReader(folder / "cut.mcap"), InputError);
      continue;
    }
    std::size_t whole = 0;
    while (whole < ends.size() && ends[whole] <= cut) ++whole;
    const Contents contents = read_all(folder / "cut.mcap");
    REQUIRE(contents.torn);
    REQUIRE(contents.records() == (whole == 0 ? 0 : whole - 1));  // the header is not one of them
    REQUIRE(contents.end_offset <= cut);
  }
}

TEST_CASE("mcap reader: a file that was flushed but never closed is torn and complete") {
  // Oracle: invariant of the writer's flush.
  const ScratchFolder folder;
  write_sample_file(folder / "open.mcap", kMessages, false);
  const Contents contents = read_all(folder / "open.mcap");
  CHECK(contents.torn);
  CHECK(contents.messages.size() == kMessages);
}

TEST_CASE("mcap reader: bad files are refused with the file and the offset") {
  // Oracle: bytes corrupted at known places; the message each rule must give.
  const ScratchFolder folder;
  const auto file = folder / "bad.mcap";
  const auto ends = write_sample_file(file, kMessages);
  auto bytes = bytes_of(file);
  const auto message_of_corrupted = [&](std::size_t at, std::uint8_t value) -> std::string {
    auto corrupted = bytes;
    corrupted[at] = value;
    write_bytes(file, corrupted);
    try {
      read_all(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  const std::string name = file.string() + ": offset ";
  const auto place = [&](std::size_t at) { return name + std::to_string(at) + ": "; };

  SECTION("magic") {
    CHECK(message_of_corrupted(5, '1') ==
          place(0) + "not an MCAP file of version 0 (its first bytes are not \\x89MCAP0\\r\\n)");
  }
  SECTION("first record is not a header") {
    CHECK(message_of_corrupted(8, 3) ==
          place(8) + "an MCAP header record must come first, not opcode 3");
  }
  SECTION("opcode 0") {
    CHECK(message_of_corrupted(ends[6], 0) ==
          place(ends[6]) + "opcode 0: no MCAP record begins here");
  }
  SECTION("chunk") {
    CHECK(message_of_corrupted(ends[6], 6) ==
          place(ends[6]) + "chunked MCAP files are not read here");
  }
  SECTION("a second header") {
    CHECK(message_of_corrupted(ends[6], 1) ==
          place(ends[6]) + "a header or footer inside the data section");
  }
  SECTION("record shorter than its fields") {
    CHECK(message_of_corrupted(ends[0] + 1, 6) ==
          place(ends[0]) + "a field of 7 bytes where 2 are left of the record");
  }
  SECTION("schema id 0") {
    CHECK(message_of_corrupted(ends[1] + 9, 0) == place(ends[1]) + "schema id 0 is not allowed");
  }
  SECTION("channel of an unknown schema") {
    CHECK(message_of_corrupted(ends[3] + 11, 9) ==
          place(ends[3]) +
              "channel 'haptic_force' names schema 9, which was not defined before it");
  }
  SECTION("message on an unknown channel") {
    CHECK(message_of_corrupted(ends[5] + 9, 9) ==
          place(ends[5]) + "message on channel 9, which was not defined before it");
  }
  SECTION("closing magic") {
    CHECK(message_of_corrupted(bytes.size() - 1, 0) ==
          place(bytes.size() - 8) + "the closing magic bytes are wrong");
  }
  SECTION("bytes behind the end") {
    bytes.push_back(0);
    CHECK(message_of_corrupted(bytes.size() - 1, 1) ==
          place(bytes.size() - 1) + "bytes after the end of the recording");
  }
  SECTION("a message record turned into an unknown kind is missed by the summary") {
    CHECK_THAT(message_of_corrupted(ends[5], 0x30),
               Catch::EndsWith("the summary counts 7 messages, the file holds 6"));
  }
}

TEST_CASE("mcap reader: a length beyond the file counts as torn there") {
  // Oracle: the record before the corrupted length is the last that must be read.
  const ScratchFolder folder;
  const auto ends = write_sample_file(folder / "a.mcap", kMessages);
  auto bytes = bytes_of(folder / "a.mcap");
  bytes[ends[7] + 7] = 0x7F;
  write_bytes(folder / "a.mcap", bytes);
  const Contents contents = read_all(folder / "a.mcap");
  CHECK(contents.torn);
  CHECK(contents.messages.size() == 2);
  CHECK(contents.end_offset == ends[7]);
}

TEST_CASE("mcap reader: records of kinds it does not know are skipped") {
  // Oracle: the specification — readers ignore unknown opcodes.
  const ScratchFolder folder;
  const auto ends = write_sample_file(folder / "a.mcap", kMessages, false);
  auto bytes = bytes_of(folder / "a.mcap");
  bytes[ends[6]] = 0x80;
  write_bytes(folder / "a.mcap", bytes);
  CHECK(read_all(folder / "a.mcap").messages.size() == kMessages - 1);
}

TEST_CASE("mcap reader: a missing file is named") {
  // Oracle: the message the rule must give.
  CHECK_THROWS_WITH(McapReader("no/such.mcap"), "no/such.mcap: no such recording");
}

}  // namespace palpate::recording
