#include "modules/recording/mcap_writer.h"

#include <zstd.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <random>

#include "modules/recording/mcap_bytes.h"
#include "modules/recording/mcap_reader.h"
#include "tests/file_size_limit.h"
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
    0x89, 'M', 'C', 'A', 'P', '0', 13,  10,                  // magic
    0x01, 15,  0,   0,   0,   0,   0,   0,   0,              // header, 15 bytes
    0,    0,   0,   0,                                       // profile ""
    7,    0,   0,   0,   'p', 'a', 'l', 'p', 'a', 't', 'e',  // library
    0x03, 18,  0,   0,   0,   0,   0,   0,   0,              // schema, 18 bytes
    1,    0,                                                 // id
    1,    0,   0,   0,   'S',                                // name
    2,    0,   0,   0,   'i', 'd',                           // encoding
    1,    0,   0,   0,   'd',                                // data
    0x04, 30,  0,   0,   0,   0,   0,   0,   0,              // channel, 30 bytes
    1,    0,                                                 // id
    1,    0,                                                 // schema id
    1,    0,   0,   0,   't',                                // topic
    3,    0,   0,   0,   'c', 'd', 'r',                      // message encoding
    10,   0,   0,   0,                                       // metadata: 10 bytes of entries
    1,    0,   0,   0,   'k', 1,   0,   0,   0,   'v',       //
});

const std::vector<std::uint8_t> kMessageRecord = bytes_from({
    0x05, 24,   0, 0, 0, 0, 0, 0, 0,  // message, 24 bytes
    1,    0,                          // channel id
    5,    0,    0, 0,                 // sequence
    0x02, 0x01, 0, 0, 0, 0, 0, 0,     // log time 258 ns
    0,    1,    0, 0, 0, 0, 0, 0,     // publish time 256 ns
    7,    8,                          // payload
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

TEST_CASE("mcap writer: what a recording cannot be written to is refused before, and left alone") {
  // Oracle: the texts by hand. A FIFO, opened to be written to, would wait for a reader.
  const ScratchFolder folder;
  const std::string at = folder.path().string() + "/";
  std::filesystem::create_directory(at + "folder");
  REQUIRE(::mkfifo((at + "fifo").c_str(), 0600) == 0);
  std::filesystem::create_symlink(at + "none", at + "link");
  const std::string no_file = ": cannot be recorded to: it is there and no regular file";
  for (const std::string& target :
       {at + "folder", at + "fifo", at + "link", std::string("/dev/full")}) {
    CHECK_THROWS_WITH(check_recording_target(target), target + no_file);
  }
  CHECK_THROWS_WITH(check_recording_target(at + "no/a.mcap"),
                    at + "no/a.mcap: cannot be recorded to: there is no folder " + at + "no");
  write_bytes(folder / "text", {'n', 'o'});
  CHECK_THROWS_WITH(check_recording_target(folder / "text"),
                    Catch::EndsWith("text: is no recording, and is not replaced by one"));
  CHECK_NOTHROW(check_recording_target(folder / "new.mcap"));
  CHECK_FALSE(std::filesystem::exists(folder / "new.mcap"));
  McapWriter(folder / "new.mcap").close();
  CHECK_NOTHROW(check_recording_target(folder / "new.mcap"));
}

TEST_CASE("mcap writer: a file has the bytes of the specification") {
  // Oracle: bytes laid out by hand from the specification; zstd unpacks the chunk, CRCs by their
  // definition.
  const ScratchFolder folder;
  write_hand_laid_file(folder / "hand.mcap");
  const auto bytes = bytes_of(folder / "hand.mcap");
  const auto packed_size = static_cast<int>(bytes[kDataSection.size() + 9 + 16 + 8 + 4 + 8]);
  const auto number_of = [](std::uint64_t value, int size) {
    std::vector<std::uint8_t> number;
    for (int i = 0; i < size; ++i) number.push_back(static_cast<std::uint8_t>(value >> 8 * i));
    return number;
  };
  auto expected = kDataSection;
  const auto append = [&](const std::vector<std::uint8_t>& more) {
    expected.insert(expected.end(), more.begin(), more.end());
  };

  const auto chunk_at = expected.size();
  append(bytes_from({0x06, 44 + packed_size, 0, 0, 0, 0, 0, 0, 0}));
  append(bytes_from({0x02, 0x01, 0, 0, 0, 0, 0, 0, 0x02, 0x01, 0, 0, 0, 0, 0, 0}));  // times
  append(bytes_from({33, 0, 0, 0, 0, 0, 0, 0}));                                     // size
  append(number_of(crc32(kMessageRecord), 4));
  append(bytes_from({4, 0, 0, 0, 'z', 's', 't', 'd', packed_size, 0, 0, 0, 0, 0, 0, 0}));
  REQUIRE(bytes.size() > expected.size() + static_cast<std::size_t>(packed_size));
  const auto* packed = bytes.data() + expected.size();
  std::vector<std::uint8_t> unpacked(kMessageRecord.size());
  CHECK(ZSTD_decompress(unpacked.data(), unpacked.size(), packed, std::size_t(packed_size)) ==
        unpacked.size());
  CHECK(unpacked == kMessageRecord);
  append({packed, packed + packed_size});
  const auto index_at = expected.size();
  append(bytes_from({0x07, 22, 0, 0, 0, 0, 0, 0, 0, 1, 0, 16, 0, 0, 0}));      // message index
  append(bytes_from({0x02, 0x01, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));  // at byte 0
  const std::uint32_t data_crc = crc32(expected);
  append(bytes_from({0x0F, 4, 0, 0, 0, 0, 0, 0, 0}));  // data end
  append(number_of(data_crc, 4));

  const std::uint64_t start = expected.size();
  append({kDataSection.begin() + 32, kDataSection.end()});  // schema and channel again
  append(bytes_from({
      0x0B, 56,   0, 0, 0, 0, 0, 0, 0,    // statistics, 56 bytes
      1,    0,    0, 0, 0, 0, 0, 0,       // messages
      1,    0,                            // schemas
      1,    0,    0, 0,                   // channels
      0,    0,    0, 0, 0, 0, 0, 0,       // attachments, metadata
      1,    0,    0, 0,                   // chunks
      0x02, 0x01, 0, 0, 0, 0, 0, 0,       // first log time
      0x02, 0x01, 0, 0, 0, 0, 0, 0,       // last log time
      10,   0,    0, 0,                   // channel counts: 10 bytes
      1,    0,    1, 0, 0, 0, 0, 0, 0, 0  //
  }));
  const auto chunk_index_at = expected.size();
  append(bytes_from({0x08, 78, 0, 0, 0, 0, 0, 0, 0}));
  append(bytes_from({0x02, 0x01, 0, 0, 0, 0, 0, 0, 0x02, 0x01, 0, 0, 0, 0, 0, 0}));  // times
  append(number_of(chunk_at, 8));
  append(number_of(index_at - chunk_at, 8));
  append(bytes_from({10, 0, 0, 0, 1, 0}));  // message indexes: channel 1
  append(number_of(index_at, 8));
  append(bytes_from({31, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 'z', 's', 't', 'd'}));
  append(bytes_from({packed_size, 0, 0, 0, 0, 0, 0, 0, 33, 0, 0, 0, 0, 0, 0, 0}));
  const auto offsets_at = expected.size();
  for (const auto& [opcode, at, length] : {std::tuple{3, start, 27},
                                           {4, start + 27, 39},
                                           {0x0B, start + 66, 65},
                                           {0x08, chunk_index_at, 87}}) {
    append(bytes_from({0x0E, 17, 0, 0, 0, 0, 0, 0, 0, opcode}));
    append(number_of(at, 8));
    append(bytes_from({length, 0, 0, 0, 0, 0, 0, 0}));
  }
  append(bytes_from({0x02, 20, 0, 0, 0, 0, 0, 0, 0}));
  append(number_of(start, 8));
  append(number_of(offsets_at, 8));
  append(number_of(crc32(std::span(expected).subspan(start)), 4));
  append({kMcapMagic.begin(), kMcapMagic.end()});
  CHECK(bytes == expected);
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

TEST_CASE("mcap writer: a file that others removed, replaced or cut is told of at the end") {
  // Oracle: what was done to it.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  const auto end_after = [&](const auto& meddle) {
    McapWriter writer(file);
    writer.flush();
    meddle();
    try {
      writer.close();
    } catch (const std::runtime_error& error) {
      CHECK_NOTHROW(writer.close());
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(end_after([] {}).empty());
  CHECK(end_after([&] { std::filesystem::remove(file); }) ==
        file.string() + ": was removed or replaced while it was recorded");
  CHECK(end_after([&] {
          std::filesystem::remove(file);
          std::ofstream(file) << "hello";
        }) == file.string() + ": was removed or replaced while it was recorded");
  std::filesystem::remove(file);
  CHECK(end_after([&] { std::filesystem::resize_file(file, 0); }) ==
        file.string() + ": was cut while it was recorded");
}

TEST_CASE("mcap writer: a full disk is reported with the file and the system's reason") {
  // Oracle: the kernel's device that is always full.
  CHECK_THROWS_WITH(McapWriter("/dev/full"), "/dev/full: cannot write: No space left on device");
}

TEST_CASE("mcap writer: a disk that is full at once leaves a file that is whole, but shorter") {
  // Oracle: the reader, which checks both CRCs: not torn, its first messages in order, as many as
  // the statistics say. A limit on the size of files fails where a full disk does, at any byte of
  // the file.
  const ScratchFolder folder;
  for (const rlim_t limit : {3'000, 20'000, 20'001, 70'123, 299'999}) {
    INFO(limit);
    const auto file = folder / "a.mcap";
    std::uint64_t written = 0;
    {
      const FileSizeLimit full(limit);
      McapWriter writer(file);
      const auto channel =
          writer.add_channel({0, writer.add_schema({0, "S", "id", "d"}), "t", "cdr", {}});
      const auto write_all = [&] {
        std::mt19937 random(1);
        for (std::uint32_t k = 0; k < 3000; ++k) {
          std::vector<std::uint8_t> payload(200);
          for (auto& byte : payload) byte = static_cast<std::uint8_t>(random());
          writer.add_message({channel, k, 1'000'000ull * k, 0, {}}, payload);
          if (k % 10 != 9) continue;
          writer.end_chunk();
          writer.flush();
        }
      };
      CHECK_THROWS_AS(write_all(), DiskFull);
      CHECK_NOTHROW(writer.close());
      written = writer.statistics().message_count;
    }
    CHECK(std::filesystem::file_size(file) <= limit);
    McapReader reader(file);
    std::uint64_t read = 0;
    while (const auto record = reader.next()) {
      const auto* message = std::get_if<McapMessage>(&*record);
      if (message == nullptr) continue;
      CHECK(message->sequence == read);
      ++read;
    }
    CHECK_FALSE(reader.torn());
    CHECK(read == written);
    CHECK(reader.statistics().value().message_count == read);
    CHECK(std::filesystem::file_size(file) + 3'000 > limit);  // a chunk has less
  }
}

TEST_CASE(
    "mcap writer: a disk that is full before a chunk of the usual size keeps what came first") {
  // Oracle: the reader. Half a second of these takes five times the limit.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  {
    const FileSizeLimit full(20'000);
    McapWriter writer(file);
    const auto channel =
        writer.add_channel({0, writer.add_schema({0, "S", "id", "d"}), "t", "cdr", {}});
    std::mt19937 random(1);
    const auto write_all = [&] {
      for (std::uint32_t k = 0; k < 1000; ++k) {
        std::vector<std::uint8_t> payload(200);
        for (auto& byte : payload) byte = static_cast<std::uint8_t>(random());
        writer.add_message({channel, k, 1'000'000ull * k, 0, {}}, payload);
        writer.flush();
      }
    };
    CHECK_THROWS_AS(write_all(), DiskFull);
  }
  McapReader reader(file);
  std::uint64_t read = 0;
  while (const auto record = reader.next()) read += std::holds_alternative<McapMessage>(*record);
  CHECK_FALSE(reader.torn());
  CHECK(read > 20);
}

TEST_CASE("mcap writer: a disk without room for a message leaves no file") {
  // Oracle: the folder, and strerror(EFBIG). One limit stops the header, one the summary of
  // nothing, one the first chunk; a limit on the size of files fails where a full disk does.
  const ScratchFolder folder;
  for (const rlim_t limit : {10, 100, 400}) {
    INFO(limit);
    {
      const FileSizeLimit full(limit);
      const auto write = [&] {
        McapWriter writer(folder / "a.mcap");
        writer.flush();
        const auto channel =
            writer.add_channel({0, writer.add_schema({0, "S", "id", "d"}), "t", "cdr", {}});
        const std::vector<std::uint8_t> payload{1, 2, 3};
        writer.add_message({channel, 1, 1, 0, {}}, payload);
        writer.close();
      };
      CHECK_THROWS_WITH(write(), (folder / "a.mcap").string() + ": cannot write: File too large");
    }
    CHECK(folder.file_count() == 0);
  }
}

TEST_CASE("mcap writer: a file that another one writes is refused and keeps what it has") {
  // Oracle: the bytes of the first; after it has gone the file may be written anew.
  const ScratchFolder folder;
  const auto file = folder / "one.mcap";
  {
    McapWriter first(file);
    const auto size = std::filesystem::file_size(file);
    CHECK_THROWS_WITH(McapWriter(file), Catch::Contains("another program is writing it"));
    CHECK_THROWS_WITH(check_recording_target(file), Catch::Contains("another program is writing"));
    CHECK(std::filesystem::file_size(file) == size);
  }
  CHECK_NOTHROW(McapWriter(file));
}

TEST_CASE("mcap writer: a file that cannot be begun is let go, and may be tried again") {
  // Oracle: the kernel's list of what is open; a file in memory may be sealed against what is
  // asked.
  const int seal = GENERATE(F_SEAL_SHRINK, F_SEAL_WRITE);
  const int memory = ::memfd_create("sealed", MFD_ALLOW_SEALING);
  REQUIRE(memory >= 0);
  if (seal == F_SEAL_SHRINK) {
    REQUIRE(::write(memory, kDataSection.data(), kDataSection.size()) > 0);
  }
  REQUIRE(::fcntl(memory, F_ADD_SEALS, seal) == 0);
  const auto open_count = [] {
    const std::filesystem::directory_iterator open("/proc/self/fd");
    return std::distance(begin(open), end(open));
  };
  const auto before = open_count();
  for (int i = 0; i < 2; ++i) {
    CHECK_THROWS_WITH(McapWriter("/proc/self/fd/" + std::to_string(memory)),
                      Catch::EndsWith("Operation not permitted"));
  }
  CHECK(open_count() == before);
  ::close(memory);
}

TEST_CASE("mcap writer: a file that cannot be opened is named") {
  // Oracle: the system's reason for a folder that does not exist.
  const ScratchFolder folder;
  CHECK_THROWS_WITH(McapWriter(folder / "missing/a.mcap"),
                    Catch::EndsWith("missing/a.mcap: cannot open: No such file or directory"));
}

}  // namespace palpate::recording
