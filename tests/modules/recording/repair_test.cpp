#include "modules/recording/repair.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "modules/recording/mcap_reader.h"
#include "tests/file_size_limit.h"
#include "tests/modules/recording/mcap_sample_file.h"

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

}  // namespace palpate::recording
