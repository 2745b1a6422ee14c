#include "modules/recording/repair.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <span>
#include <string_view>

#include "modules/core/error.h"
#include "modules/recording/mcap_reader.h"
#include "modules/recording/sample_reader.h"
#include "tests/file_size_limit.h"
#include "tests/modules/recording/mcap_sample_file.h"
#include "tests/modules/recording/payloads.h"
#include "tests/times.h"

namespace palpate::recording {
namespace {

std::vector<McapMessage> messages_in(const std::filesystem::path& file) {
  McapReader reader(file);
  std::vector<McapMessage> messages;
  while (const auto record = reader.next()) {
    if (const auto* message = std::get_if<McapMessage>(&*record)) messages.push_back(*message);
  }
  CHECK_FALSE(reader.torn());
  CHECK(reader.statistics().has_value());
  return messages;
}

/// Of this version: ten node positions and ten forces, in five chunks.
void write_own(const std::filesystem::path& file, bool close = true) {
  SampleFile writer(file, {.domain = 3, .session = "bench"});
  for (std::uint64_t k = 1; k <= 10; ++k) {
    writer.add(raw_sample(bus::kNodePositions, node_positions(k, 1e-3, 5), std::int64_t(k) * kMs));
    HapticForce force;
    force.header = {k, 0, std::int64_t(k)};
    writer.add(raw_sample(bus::kHapticForce, force, std::int64_t(k) * kMs));
    if (k % 2 == 0) writer.end_chunk();
  }
  writer.flush();
  if (close) writer.close();
}

using Samples = std::vector<std::pair<std::string_view, std::vector<std::uint8_t>>>;

Samples samples_of(const std::filesystem::path& file) {
  SampleReader reader(file);
  Samples samples;
  while (auto sample = reader.next()) {
    samples.emplace_back(sample->topic->name, std::move(sample->payload));
  }
  return samples;
}

/// Where schemas and channels begin and end, before the first chunk.
std::vector<std::pair<std::size_t, std::size_t>> definitions_in(
    const std::vector<std::uint8_t>& bytes) {
  std::vector<std::pair<std::size_t, std::size_t>> found;
  std::size_t place = kMcapMagic.size();
  for (auto opcode = bytes[place]; opcode != std::uint8_t(McapOpcode::kChunk);
       opcode = bytes[place]) {
    const auto length = ByteReader(std::span(bytes).subspan(place + 1)).u64();
    const std::size_t end = place + kMcapEnvelopeBytes + length;
    if (opcode == std::uint8_t(McapOpcode::kSchema) || opcode == std::uint8_t(McapOpcode::kChannel))
      found.emplace_back(place, end);
    place = end;
  }
  return found;
}

}  // namespace

TEST_CASE("repair: a torn recording is whole again up to its last whole chunk") {
  // Oracle: the messages written before the cut, three to a chunk.
  const ScratchFolder folder;
  const auto ends = write_sample_file(folder / "whole.mcap", 9);
  const auto bytes = bytes_of(folder / "whole.mcap");
  write_bytes(folder / "torn.mcap", {bytes.begin(), bytes.begin() + std::ptrdiff_t(ends[7] + 20)});
  const RepairReport report = repair(folder / "torn.mcap", folder / "again.mcap");
  CHECK(report.torn);
  CHECK(report.skipped == 0);
  CHECK(report.samples == 6);
  const auto messages = messages_in(folder / "again.mcap");
  REQUIRE(messages.size() == 6);
  for (int i = 0; i < 6; ++i) {
    const McapMessage& message = messages[std::size_t(i)];
    CHECK(message.sequence == sample_message(i).sequence);
    CHECK(message.log_time_ns == sample_message(i).log_time_ns);
    CHECK(message.data == sample_message(i).data);
  }
}

TEST_CASE("repair: a damaged chunk is left out, an old recording gets its indexes") {
  // Oracle: the messages of the other chunks; of an old file, all.
  const ScratchFolder folder;
  const auto ends = write_sample_file(folder / "a.mcap", 9);
  auto bytes = bytes_of(folder / "a.mcap");
  bytes[ends[6] + 9 + 16 + 8] ^= 1;  // the CRC of the second
  write_bytes(folder / "a.mcap", bytes);
  const RepairReport report = repair(folder / "a.mcap", folder / "again.mcap");
  CHECK_FALSE(report.torn);
  CHECK(report.skipped == 1);
  CHECK(messages_in(folder / "again.mcap").size() == 6);
  write_old_sample_file(folder / "old.mcap", 9);
  CHECK(repair(folder / "old.mcap", folder / "new.mcap").samples == 9);
  CHECK(messages_in(folder / "new.mcap").size() == 9);
}

TEST_CASE("repair: replaces nothing, and says before that it cannot write") {
  // Oracle: the message, and the file's bytes.
  const ScratchFolder folder;
  write_sample_file(folder / "a.mcap", 3);
  const auto before = bytes_of(folder / "a.mcap");
  CHECK_THROWS_WITH(
      repair(folder / "a.mcap", folder / "a.mcap"),
      Catch::EndsWith("a.mcap: is there already; a repaired recording replaces nothing"));
  CHECK(bytes_of(folder / "a.mcap") == before);
  CHECK_THROWS_WITH(repair(folder / "a.mcap", folder / "no/b.mcap"),
                    Catch::Contains("b.mcap: cannot be recorded to: there is no folder "));
}

TEST_CASE("repair: a full disk leaves nothing that would refuse the next try") {
  // Oracle: the folder; a limit on the size of files fails where a full disk does.
  const ScratchFolder folder;
  write_sample_file(folder / "a.mcap", 300);
  {
    const FileSizeLimit limit(600);
    CHECK_THROWS_WITH(repair(folder / "a.mcap", folder / "b.mcap"),
                      Catch::StartsWith((folder / "b.mcap").string() + ": cannot write: "));
  }
  CHECK(folder.file_count() == 1);
  CHECK(repair(folder / "a.mcap", folder / "b.mcap").samples == 300);
  CHECK(folder.file_count() == 2);
}

TEST_CASE("repair: any damaged byte of a type or topic is mended from the summary") {
  // Oracle: the samples of the sound recording, each with its topic and payload. Each bit of an
  // opcode and of a length, and every 37th byte of what a record holds.
  const ScratchFolder folder;
  write_own(folder / "sound.mcap");
  const auto sound = bytes_of(folder / "sound.mcap");
  const auto samples = samples_of(folder / "sound.mcap");
  REQUIRE(samples.size() == 20);
  std::size_t damaged = 0;
  const auto check_with = [&](std::size_t place, int bit) {
    INFO("byte " << place << ", bit " << bit);
    auto bytes = sound;
    bytes[place] ^= static_cast<std::uint8_t>(1 << bit);
    write_bytes(folder / "damaged.mcap", bytes);
    std::filesystem::remove(folder / "mended.mcap");
    const RepairReport report = repair(folder / "damaged.mcap", folder / "mended.mcap");
    CHECK(report.mended >= 1);  // with a length go those up to the next known place
    CHECK(report.samples_left_out == 0);
    CHECK(samples_of(folder / "mended.mcap") == samples);
    ++damaged;
  };
  for (const auto& [begin, end] : definitions_in(sound)) {
    for (std::size_t place = begin; place < begin + kMcapEnvelopeBytes; ++place) {
      for (int bit = 0; bit < 8; ++bit) check_with(place, bit);
    }
    for (std::size_t place = begin + kMcapEnvelopeBytes; place < end; place += 37) {
      check_with(place, 0);
    }
  }
  CHECK(damaged > 4 * 72);
}

TEST_CASE("repair: of a torn recording a damaged type or topic is left out, and said") {
  // Oracle: the samples of the sound recording of the other topic; the warning. No byte makes a
  // file that cannot be read.
  const ScratchFolder folder;
  write_own(folder / "sound.mcap", false);
  const auto sound = bytes_of(folder / "sound.mcap");
  const auto samples = samples_of(folder / "sound.mcap");
  REQUIRE(samples.size() == 20);
  std::size_t left_out = 0;
  for (const auto& [begin, end] : definitions_in(sound)) {
    for (std::size_t place = begin + kMcapEnvelopeBytes + 2; place < end; place += 37) {
      INFO("byte " << place);
      auto bytes = sound;
      bytes[place] ^= 1;
      write_bytes(folder / "damaged.mcap", bytes);
      std::filesystem::remove(folder / "mended.mcap");
      const RepairReport report = repair(folder / "damaged.mcap", folder / "mended.mcap");
      const auto mended = samples_of(folder / "mended.mcap");
      CHECK(mended.size() + report.samples_left_out == samples.size());
      if (report.samples_left_out == 0) continue;  // a comment in the type, a writer's number
      ++left_out;
      CHECK(mended.size() == samples.size() / 2);
      REQUIRE(report.warnings.size() + report.skipped > 0);
    }
  }
  CHECK(left_out > 4);
}

TEST_CASE("repair: what cannot be mended leaves no file and no success") {
  // Oracle: the message and the folder. The session's clock is in metadata, which have one copy.
  const ScratchFolder folder;
  write_own(folder / "a.mcap");
  auto bytes = bytes_of(folder / "a.mcap");
  const std::string key = "start_unix_ns";
  const auto place = std::ranges::search(bytes, key);
  REQUIRE(!place.empty());
  place.end()[4] = 'x';  // behind the value's length
  write_bytes(folder / "a.mcap", bytes);
  CHECK_THROWS_WITH(repair(folder / "a.mcap", folder / "b.mcap"),
                    Catch::StartsWith((folder / "a.mcap").string() + ": cannot be mended: ") &&
                        Catch::Contains("is no time in ns"));
  CHECK(folder.file_count() == 1);
}

}  // namespace palpate::recording
