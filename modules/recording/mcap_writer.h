// Writes an MCAP file: no chunks, no compression, so that every record stands by itself and a
// file whose writer was killed is whole up to its last record.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "modules/recording/mcap_records.h"

namespace palpate::recording {

/// Records are gathered in memory and written whole by flush(), by close(), and when a megabyte
/// has gathered. Not thread-safe.
class McapWriter {
 public:
  /// Replaces an existing recording. @throws InputError if the file holds something else;
  /// std::runtime_error naming the file and the system's reason
  explicit McapWriter(const std::filesystem::path& file);
  /// Without close() the file stays as a killed writer leaves it.
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Gives the schema an id, which is returned; `schema.id` is not read.
  std::uint16_t add_schema(McapSchema schema);
  /// Gives the channel an id, which is returned; `channel.id` is not read.
  std::uint16_t add_channel(McapChannel channel);
  /// @param data  payload; all else is taken from `message`, whose own data is not read
  void add_message(const McapMessage& message, std::span<const std::uint8_t> data);
  void add_metadata(const McapMetadata& metadata);

  /// @throws std::runtime_error naming the file and the system's reason (disk full, …)
  void flush();
  /// Ends the data section, writes the summary and the footer, closes. A second call does nothing.
  void close();

  const McapStatistics& statistics() const { return statistics_; }
  std::uint64_t bytes_written() const { return offset_; }  ///< including what flush() still holds

 private:
  struct MetadataPlace {
    std::uint64_t offset = 0, length = 0;
    std::string name;
  };

  void append(std::span<const std::uint8_t> bytes);
  void append_record(McapOpcode opcode, std::span<const std::uint8_t> content);
  void append_summary();
  [[noreturn]] void fail(const char* doing, int system_error) const;

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::uint64_t offset_ = 0;
  std::vector<std::uint8_t> pending_;
  std::vector<std::uint8_t> scratch_;  ///< content of the record being built
  std::vector<McapSchema> schemas_;
  std::vector<McapChannel> channels_;
  std::vector<MetadataPlace> metadata_places_;
  McapStatistics statistics_;
};

}  // namespace palpate::recording
