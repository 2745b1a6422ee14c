// A small MCAP file with every kind of record that recordings use.
#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "modules/recording/mcap_bytes.h"
#include "modules/recording/mcap_codec.h"
#include "modules/recording/mcap_writer.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {

struct SampleContents {
  McapMetadata metadata{"session", {{"name", "bench"}, {"clock", "monotonic"}}};
  std::vector<McapSchema> schemas{{1, "Force", "omgidl", "struct Force { double f; };"},
                                  {2, "Pose", "omgidl", "struct Pose { double x; };"}};
  std::vector<McapChannel> channels{{1, 1, "haptic_force", "cdr", {}},
                                    {2, 2, "probe_state", "cdr", {{"key", "probe"}}}};
};

/// Message i of them: every third of the second channel.
inline McapMessage sample_message(int i) {
  const auto k = static_cast<std::uint64_t>(i);
  return {static_cast<std::uint16_t>(i % 3 == 0 ? 2 : 1), static_cast<std::uint32_t>(i + 1),
          1'000'000 * (k + 1), 999'000 * (k + 1),
          std::vector<std::uint8_t>(static_cast<std::size_t>(i), std::uint8_t(0xA0 + i))};
}

/// Writes metadata, two schemas, two channels and `message_count` messages, three to a chunk.
/// @return the offsets behind the header, metadata, schemas and channels, and behind each chunk
/// with its indexes
inline std::vector<std::uint64_t> write_sample_file(const std::filesystem::path& file,
                                                    int message_count, bool close = true) {
  const SampleContents contents;
  McapWriter writer(file);
  std::vector<std::uint64_t> ends{writer.bytes_written()};
  const auto note = [&] { ends.push_back(writer.bytes_written()); };
  writer.add_metadata(contents.metadata);
  note();
  for (const auto& schema : contents.schemas) writer.add_schema(schema), note();
  for (const auto& channel : contents.channels) writer.add_channel(channel), note();
  for (int i = 0; i < message_count; ++i) {
    writer.add_message(sample_message(i), sample_message(i).data);
    if (i % 3 != 2 && i + 1 != message_count) continue;
    writer.end_chunk();
    note();
  }
  if (close) {
    writer.close();
  } else {
    writer.flush();
  }
  return ends;
}

/// The same as recordings were before they had chunks: every record by itself, no CRC but that of
/// the summary.
/// @return the offsets behind each record of the data section
inline std::vector<std::uint64_t> write_old_sample_file(const std::filesystem::path& file,
                                                        int message_count, bool close = true) {
  const SampleContents contents;
  std::vector<std::uint8_t> bytes(kMcapMagic.begin(), kMcapMagic.end());
  std::vector<std::uint64_t> ends;
  const auto append = [&](McapOpcode opcode, const McapContent& content) {
    append_record(bytes, opcode, content);
    ends.push_back(bytes.size());
  };
  append(McapOpcode::kHeader, content_of(McapHeader{"", "palpate"}));
  append(McapOpcode::kMetadata, content_of(contents.metadata));
  for (const auto& schema : contents.schemas) append(McapOpcode::kSchema, content_of(schema));
  for (const auto& channel : contents.channels) append(McapOpcode::kChannel, content_of(channel));
  for (int i = 0; i < message_count; ++i) {
    append_message(bytes, sample_message(i), sample_message(i).data);
    ends.push_back(bytes.size());
  }
  if (close) {
    append_record(bytes, McapOpcode::kDataEnd, McapContent(4, 0));
    const std::uint64_t start = bytes.size();
    McapStatistics statistics;
    statistics.message_count = static_cast<std::uint64_t>(message_count);
    append_record(bytes, McapOpcode::kStatistics, content_of(statistics));
    std::vector<std::uint8_t> summary(bytes.begin() + std::ptrdiff_t(start), bytes.end());
    ByteWriter(summary).u8(2).u64(kFooterBytes).u64(start).u64(0);
    ByteWriter(summary).u32(crc32(summary)).raw(kMcapMagic);
    bytes.resize(start);
    ByteWriter(bytes).raw(summary);
  }
  write_bytes(file, bytes);
  return ends;
}

}  // namespace palpate::recording
