#include "modules/recording/mcap_writer.h"

#include <catch2/catch.hpp>

#include "modules/recording/mcap_bytes.h"
#include "tests/modules/recording/mcap_sample_file.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

std::vector<std::uint8_t> bytes_from(std::initializer_list<int> values) {
  std::vector<std::uint8_t> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::uint8_t>(value));
  return bytes;
}

// One schema "S" with data "d", one channel "t", one message with payload 7 8, laid out by hand
// from the records' tables in the specification.
const std::vector<std::uint8_t> kDataSection = bytes_from({
    0x89, 'M',  'C', 'A', 'P', '0', 13,  10,                  // magic
    0x01, 15,   0,   0,   0,   0,   0,   0,   0,              // header, 15 bytes
    0,    0,    0,   0,                                       // profile ""
    7,    0,    0,   0,   'p', 'a', 'l', 'p', 'a', 't', 'e',  // library
    0x03, 18,   0,   0,   0,   0,   0,   0,   0,              // schema, 18 bytes
    1,    0,                                                  // id
    1,    0,    0,   0,   'S',                                // name
    2,    0,    0,   0,   'i', 'd',                           // encoding
    1,    0,    0,   0,   'd',                                // data
    0x04, 30,   0,   0,   0,   0,   0,   0,   0,              // channel, 30 bytes
    1,    0,                                                  // id
    1,    0,                                                  // schema id
    1,    0,    0,   0,   't',                                // topic
    3,    0,    0,   0,   'c', 'd', 'r',                      // message encoding
    10,   0,    0,   0,                                       // metadata: 10 bytes of entries
    1,    0,    0,   0,   'k', 1,   0,   0,   0,   'v',       //
    0x05, 24,   0,   0,   0,   0,   0,   0,   0,              // message, 24 bytes
    1,    0,                                                  // channel id
    5,    0,    0,   0,                                       // sequence
    0x02, 0x01, 0,   0,   0,   0,   0,   0,                   // log time 258 ns
    0,    1,    0,   0,   0,   0,   0,   0,                   // publish time 256 ns
    7,    8,                                                  // payload
});

const std::vector<std::uint8_t> kClosing = bytes_from({
    0x0F, 4, 0, 0, 0, 0, 0, 0, 0,  // data end
    0, 0, 0, 0,                    // CRC not given
});

void write_hand_laid_file(const std::filesystem::path& file) {
  McapWriter writer(file);
  const auto schema = writer.add_schema({0, "S", "id", "d"});
  const auto channel = writer.add_channel({0, schema, "t", "cdr", {{"k", "v"}}});
  const std::vector<std::uint8_t> payload{7, 8};
  writer.add_message({channel, 5, 258, 256, {}}, payload);
  writer.close();
}

}  // namespace

TEST_CASE("mcap writer: replaces a recording, and nothing else") {
  // Oracle: the message, and the bytes that stay.
  const ScratchFolder folder;
  write_bytes(folder / "scene.yaml", {'p', 'a', 'l', 'p', 'a', 't', 'e', ':', ' ', '1'});
  CHECK_THROWS_WITH(McapWriter(folder / "scene.yaml"),
                    Catch::EndsWith("scene.yaml: is no recording, and is not replaced by one"));
  CHECK(std::filesystem::file_size(folder / "scene.yaml") == 10);
  write_bytes(folder / "empty", {});
  for (int i = 0; i < 2; ++i) {
    for (const char* name : {"empty", "new.mcap"}) CHECK_NOTHROW(McapWriter(folder / name));
  }
}

TEST_CASE("mcap writer: the data section has the bytes of the specification") {
  // Oracle: bytes laid out by hand from the specification.
  const ScratchFolder folder;
  write_hand_laid_file(folder / "hand.mcap");
  const auto bytes = bytes_of(folder / "hand.mcap");
  auto expected = kDataSection;
  expected.insert(expected.end(), kClosing.begin(), kClosing.end());
  REQUIRE(bytes.size() > expected.size());
  CHECK(std::vector(bytes.begin(), bytes.begin() + std::ptrdiff_t(expected.size())) == expected);
}

TEST_CASE("mcap writer: the summary section has the bytes of the specification") {
  // Oracle: bytes laid out by hand from the specification; CRC by its definition.
  const ScratchFolder folder;
  write_hand_laid_file(folder / "hand.mcap");
  const auto bytes = bytes_of(folder / "hand.mcap");
  const std::uint8_t start = static_cast<std::uint8_t>(kDataSection.size() + kClosing.size());
  std::vector<std::uint8_t> expected(kDataSection.begin() + 32, kDataSection.begin() + 98);
  const auto append = [&](const std::vector<std::uint8_t>& more) {
    expected.insert(expected.end(), more.begin(), more.end());
  };
  append(bytes_from({
      0x0B, 56,   0, 0, 0, 0, 0, 0, 0,    // statistics, 56 bytes
      1,    0,    0, 0, 0, 0, 0, 0,       // messages
      1,    0,                            // schemas
      1,    0,    0, 0,                   // channels
      0,    0,    0, 0, 0, 0, 0, 0,       // attachments, metadata
      0,    0,    0, 0,                   // chunks
      0x02, 0x01, 0, 0, 0, 0, 0, 0,       // first log time
      0x02, 0x01, 0, 0, 0, 0, 0, 0,       // last log time
      10,   0,    0, 0,                   // channel counts: 10 bytes
      1,    0,    1, 0, 0, 0, 0, 0, 0, 0  //
  }));
  const int schema_at = start, channel_at = start + 27, statistics_at = start + 66;
  for (const auto [opcode, at, length] :
       {std::array{3, schema_at, 27}, {4, channel_at, 39}, {0x0B, statistics_at, 65}}) {
    append(bytes_from({0x0E, 17, 0, 0, 0, 0, 0, 0, 0, opcode}));
    append(bytes_from({at, 0, 0, 0, 0, 0, 0, 0, length, 0, 0, 0, 0, 0, 0, 0}));
  }
  const int offsets_at = start + 131;
  append(bytes_from({0x02, 20, 0, 0, 0, 0, 0, 0, 0}));
  append(bytes_from({start, 0, 0, 0, 0, 0, 0, 0, offsets_at & 0xFF, offsets_at >> 8}));
  append(bytes_from({0, 0, 0, 0, 0, 0}));
  const std::uint32_t crc = crc32(expected);
  for (int i = 0; i < 4; ++i) expected.push_back(static_cast<std::uint8_t>(crc >> (8 * i)));
  expected.insert(expected.end(), kMcapMagic.begin(), kMcapMagic.end());
  CHECK(std::vector(bytes.begin() + start, bytes.end()) == expected);
}

TEST_CASE("mcap writer: what flush() has written is in the file before close()") {
  // Oracle: invariant — the file's size is the writer's own count.
  const ScratchFolder folder;
  McapWriter writer(folder / "open.mcap");
  writer.add_metadata({"session", {{"name", "x"}}});
  writer.flush();
  CHECK(std::filesystem::file_size(folder / "open.mcap") == writer.bytes_written());
}

TEST_CASE("mcap writer: statistics count messages per channel and span the log times") {
  // Oracle: counted by hand: of messages 0 … 6 every third is a pose.
  const ScratchFolder folder;
  McapWriter writer(folder / "s.mcap");
  const auto schema = writer.add_schema({0, "S", "omgidl", ""});
  const auto a = writer.add_channel({0, schema, "a", "cdr", {}});
  const auto b = writer.add_channel({0, schema, "b", "cdr", {}});
  CHECK(writer.statistics().message_start_time_ns == 0);
  for (const std::uint64_t time : {50, 20, 90}) writer.add_message({a, 1, time, 0, {}}, {});
  writer.add_message({b, 1, 60, 0, {}}, {});
  CHECK(writer.statistics().message_count == 4);
  CHECK(writer.statistics().channel_message_counts.at(a) == 3);
  CHECK(writer.statistics().channel_message_counts.at(b) == 1);
  CHECK(writer.statistics().message_start_time_ns == 20);
  CHECK(writer.statistics().message_end_time_ns == 90);
}

TEST_CASE("mcap writer: a full disk is reported with the file and the system's reason") {
  // Oracle: the kernel's device that is always full.
  CHECK_THROWS_WITH(McapWriter("/dev/full"), "/dev/full: cannot write: No space left on device");
}

TEST_CASE("mcap writer: a file that cannot be opened is named") {
  // Oracle: the system's reason for a folder that does not exist.
  const ScratchFolder folder;
  CHECK_THROWS_WITH(McapWriter(folder / "missing/a.mcap"),
                    Catch::EndsWith("missing/a.mcap: cannot open: No such file or directory"));
}

}  // namespace palpate::recording
