#include "modules/recording/mcap_reader.h"

#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <fstream>

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
  std::uint64_t skipped = 0;
  bool torn = false;
  std::uint64_t end_offset = 0;
  std::size_t records() const {
    return schemas.size() + channels.size() + messages.size() + metadata.size();
  }
};

Contents read_all(const std::filesystem::path& file, McapDamage damage = McapDamage::kRefuse) {
  McapReader reader(file, damage);
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
  contents.skipped = reader.skipped();
  contents.end_offset = reader.offset();
  return contents;
}

}  // namespace

TEST_CASE("mcap reader: reads back what the writer was given, in chunks or, as of old, without") {
  // Oracle: round trip — the values in SampleContents and sample_message().
  const ScratchFolder folder;
  GENERATE(true, false) ? write_sample_file(folder / "a.mcap", kMessages)
                        : write_old_sample_file(folder / "a.mcap", kMessages);
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

TEST_CASE(
    "mcap reader: a file without chunks, cut at any byte, opens up to its last whole record") {
  // Oracle: the record ends noted by the writer; everything before the cut must be there.
  const ScratchFolder folder;
  const auto ends = write_old_sample_file(folder / "whole.mcap", kMessages);
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

TEST_CASE("mcap reader: a chunked file, cut at any byte, opens up to its last whole chunk") {
  // Oracle: the ends noted by the writer; every message of a chunk that is whole must be there.
  const ScratchFolder folder;
  const auto ends = write_sample_file(folder / "whole.mcap", kMessages);
  const auto bytes = bytes_of(folder / "whole.mcap");
  const std::size_t first_chunk = 5;  // ends of header, metadata, schemas and channels come before
  for (std::size_t cut = ends[first_chunk]; cut < bytes.size(); ++cut) {
    write_bytes(folder / "cut.mcap", {bytes.begin(), bytes.begin() + std::ptrdiff_t(cut)});
    CAPTURE(cut);
    std::size_t chunks = 0;  // with all of their indexes, which come behind them
    while (first_chunk + chunks + 1 < ends.size() && ends[first_chunk + chunks + 1] <= cut) {
      ++chunks;
    }
    const Contents contents = read_all(folder / "cut.mcap");
    REQUIRE(contents.torn);
    REQUIRE(contents.messages.size() >= std::min<std::size_t>(3 * chunks, kMessages));
    REQUIRE(contents.messages.size() <= std::min<std::size_t>(3 * chunks + 3, kMessages));
    REQUIRE(contents.end_offset <= cut);
  }
}

TEST_CASE("mcap reader: a damaged chunk is named by its place, or left out where that is asked") {
  // Oracle: one bit of the middle chunk's compressed bytes; the messages of the two others.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  const auto ends = write_sample_file(file, kMessages);
  auto bytes = bytes_of(file);
  const std::uint64_t chunk = ends[6];
  for (std::uint64_t at = chunk + 9 + 16 + 8; at < chunk + 9 + 16 + 8 + 4; ++at) {  // its CRC
    auto wrong = bytes;
    wrong[at] ^= 0x10;
    write_bytes(file, wrong);
    CHECK_THROWS_WITH(read_all(file), file.string() + ": offset " + std::to_string(chunk) +
                                          ": a chunk is damaged: its CRC is wrong");
    const Contents contents = read_all(file, McapDamage::kSkip);
    CHECK(contents.skipped == 1);
    REQUIRE(contents.messages.size() == 4);
    CHECK(contents.messages[2].sequence == 3);
    CHECK(contents.messages[3].sequence == 7);
  }
}

TEST_CASE("mcap reader: damage between the chunks shows in the CRC of the data section") {
  // Oracle: a letter of the metadata, which no other check covers.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  const auto ends = write_sample_file(file, kMessages);
  auto bytes = bytes_of(file);
  bytes[ends[0] + 9 + 4] ^= 1;
  write_bytes(file, bytes);
  CHECK_THROWS_WITH(read_all(file), file.string() + ": offset " + std::to_string(ends.back()) +
                                        ": the recording is damaged before this place: its CRC is "
                                        "wrong");
}

TEST_CASE("mcap reader: damage of the summary shows in its CRC") {
  // Oracle: a letter of a schema in the summary.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  const auto ends = write_sample_file(file, kMessages);
  auto bytes = bytes_of(file);
  bytes[ends.back() + 13 + 9 + 2 + 4] ^= 1;
  write_bytes(file, bytes);
  CHECK_THROWS_WITH(read_all(file), Catch::EndsWith(": the summary is damaged: its CRC is wrong"));
}

TEST_CASE("mcap reader: a recording with any byte changed is refused or read, never a crash") {
  // Oracle: every byte of a file, each changed in three ways; messages that are read although all
  // is checked can only be those that were written.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  GENERATE(true, false) ? write_sample_file(file, kMessages)
                        : write_old_sample_file(file, kMessages);
  const auto bytes = bytes_of(file);
  int refused = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const int change : {0x01, 0x80, 0xFF}) {
      auto wrong = bytes;
      wrong[at] = static_cast<std::uint8_t>(wrong[at] ^ change);
      write_bytes(file, wrong);
      CAPTURE(at, change);
      try {
        const Contents contents = read_all(file);
        REQUIRE(contents.messages.size() <= kMessages);
      } catch (const InputError& error) {
        ++refused;
        REQUIRE_THAT(error.what(), Catch::StartsWith(file.string() + ": offset "));
      }
      try {
        read_all(file, McapDamage::kSkip);
      } catch (const InputError&) {  // the magic, or the header
        REQUIRE(at < 9 + 9 + 15);
      }
    }
  }
  CHECK(refused > 100);
}

TEST_CASE("mcap reader: bad files are refused with the file and the offset") {
  // Oracle: bytes corrupted at known places; the message each rule must give.
  const ScratchFolder folder;
  const auto file = folder / "bad.mcap";
  const auto ends = write_old_sample_file(file, kMessages);
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
  const auto ends = write_old_sample_file(folder / "a.mcap", kMessages);
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
  const auto ends = write_old_sample_file(folder / "a.mcap", kMessages, false);
  auto bytes = bytes_of(folder / "a.mcap");
  bytes[ends[6]] = 0x80;
  write_bytes(folder / "a.mcap", bytes);
  CHECK(read_all(folder / "a.mcap").messages.size() == kMessages - 1);
}

TEST_CASE("mcap reader: a record that is too long is refused, or passed over if it is of no use") {
  // Oracle: the messages before and behind two sparse gigabytes; the process's peak of memory.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  write_old_sample_file(file, kMessages, false);
  const auto place = std::filesystem::file_size(file);
  constexpr std::uint64_t kLength = std::uint64_t{2} << 30;
  const auto append = [&](std::uint8_t opcode) {
    std::vector<std::uint8_t> envelope, message;
    ByteWriter(envelope).u8(opcode).u64(kLength);
    append_message(message, sample_message(0), sample_message(0).data);
    std::ofstream stream(file, std::ios::binary | std::ios::app);
    stream.write(reinterpret_cast<const char*>(envelope.data()), std::ptrdiff_t(envelope.size()));
    stream.flush();
    std::filesystem::resize_file(file, place + envelope.size() + kLength);
    stream.write(reinterpret_cast<const char*>(message.data()), std::ptrdiff_t(message.size()));
  };
  const auto peak_kib = [] {
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    return used.ru_maxrss;
  };
  const auto before = peak_kib();
  SECTION("of a kind that is not used") {
    append(0x80);
    CHECK(read_all(file).messages.size() == kMessages + 1);
  }
  SECTION("an attachment") {
    append(static_cast<std::uint8_t>(McapOpcode::kAttachment));
    CHECK_THROWS_WITH(read_all(file),
                      file.string() + ": offset " + std::to_string(place) +
                          ": a record of 2147483648 bytes; at most 268435456 are read");
    const Contents contents = read_all(file, McapDamage::kSkip);
    CHECK(contents.messages.size() == kMessages + 1);
    CHECK(contents.skipped == 1);
  }
  CHECK(peak_kib() - before < 100'000);
}

TEST_CASE("mcap reader: what is passed over leaves the CRC of its section unknown, not wrong") {
  // Oracle: a whole recording, with a CRC that cannot cover what was put in afterwards.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  const auto ends = write_sample_file(file, kMessages);
  auto bytes = bytes_of(file);
  std::vector<std::uint8_t> unused;
  append_record(unused, static_cast<McapOpcode>(0x80), McapContent((1u << 20) + 1));
  bytes.insert(bytes.begin() + std::ptrdiff_t(ends[0]), unused.begin(), unused.end());
  write_bytes(file, bytes);
  CHECK(read_all(file).messages.size() == kMessages);
}

TEST_CASE("mcap reader: a missing file is named") {
  // Oracle: the message the rule must give.
  CHECK_THROWS_WITH(McapReader("no/such.mcap"), "no/such.mcap: no such file");
}

}  // namespace palpate::recording
