// Reads an MCAP file front to back, without its summary: also one that was never closed.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <variant>

#include "modules/recording/mcap_records.h"

namespace palpate::recording {

using McapRecord = std::variant<McapSchema, McapChannel, McapMessage, McapMetadata>;

class McapReader {
 public:
  /// @throws InputError if the file cannot be read, is not MCAP version 0, or does not begin with
  /// a header record
  explicit McapReader(const std::filesystem::path& file);

  /// The next record of the data section; none at its end, be it regular or torn. Kinds of record
  /// that recordings do not use are skipped.
  /// @throws InputError "file: offset N: …" where the bytes are not records
  std::optional<McapRecord> next();

  const McapHeader& header() const { return header_; }
  /// After next() gave none: the file lacks its regular end, the writer was stopped hard.
  bool torn() const { return torn_; }
  /// First byte after the last whole record read.
  std::uint64_t offset() const { return offset_; }
  /// Start of the record that next() returned last.
  std::uint64_t record_offset() const { return record_offset_; }
  std::uint64_t file_bytes() const { return file_bytes_; }
  /// From the summary; none in a torn file.
  const std::optional<McapStatistics>& statistics() const { return statistics_; }

 private:
  bool read_envelope(std::uint8_t& opcode);
  std::optional<McapRecord> parse(McapOpcode opcode);
  McapChannel parse_channel();
  McapMessage parse_message();
  void read_closing_part();
  void check_footer();
  bool read_bytes(std::uint8_t* bytes, std::size_t size);
  [[noreturn]] void refuse(std::uint64_t offset, const std::string& what) const;

  std::filesystem::path file_;
  std::ifstream stream_;
  std::uint64_t file_bytes_ = 0;
  std::uint64_t offset_ = 0;
  std::uint64_t record_offset_ = 0;
  std::vector<std::uint8_t> content_;
  McapHeader header_;
  std::set<std::uint16_t> schema_ids_;
  std::set<std::uint16_t> channel_ids_;
  std::uint64_t message_count_ = 0;
  std::optional<McapStatistics> statistics_;
  bool ended_ = false;
  bool torn_ = false;
};

}  // namespace palpate::recording
