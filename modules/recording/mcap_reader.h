// Reads an MCAP file front to back, without its indexes: also one that was never closed. Messages
// may lie in chunks or, as older recordings have them, beside each other.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <variant>

#include "modules/recording/mcap_summary.h"

namespace palpate::recording {

using McapRecord = std::variant<McapSchema, McapChannel, McapMessage, McapMetadata, McapAttachment>;

/// What becomes of records whose bytes are wrong.
enum class McapDamage {
  kRefuse,
  kSkip,  ///< counted; where no record can be told from the next any more, the file ends as if torn
};

class McapReader {
 public:
  /// @throws InputError if the file cannot be read, is not MCAP version 0, or does not begin with
  /// a header record
  explicit McapReader(const std::filesystem::path& file, McapDamage damage = McapDamage::kRefuse);

  /// The next record of the data section; none at its end, be it regular or torn. Kinds of record
  /// that recordings do not use are skipped.
  /// @throws InputError "file: offset N: …" where the bytes are not records, or a CRC is wrong
  std::optional<McapRecord> next();

  /// Before the first next(), with McapDamage::kSkip: schemas and channels of the summary need no
  /// record before their messages, and where one's length is wrong the next place is gone on from.
  void take(const McapSummary& summary);

  const McapHeader& header() const { return header_; }
  /// After next() gave none: the file lacks its regular end, the writer was stopped hard.
  bool torn() const { return torn_; }
  /// First byte after the last whole record read.
  std::uint64_t offset() const { return offset_; }
  /// Start of the record that next() returned last, or of the chunk it lies in.
  std::uint64_t record_offset() const { return record_offset_; }
  /// Chunks and other records left out with McapDamage::kSkip.
  std::uint64_t skipped() const { return skipped_; }
  /// Messages left out with McapDamage::kSkip, for their channel's record was.
  std::uint64_t undefined_messages() const { return undefined_messages_; }
  std::uint64_t file_bytes() const { return file_bytes_; }
  /// From the summary; none in a torn file.
  const std::optional<McapStatistics>& statistics() const { return statistics_; }

 private:
  std::optional<McapRecord> next_beside_chunks();
  std::optional<McapRecord> next_in_chunk();
  bool read_envelope(std::uint8_t& opcode);
  bool lost_its_way(std::uint8_t opcode, std::uint64_t length);
  bool passes_over(std::uint8_t opcode, std::uint64_t length);
  std::optional<McapRecord> parse(McapOpcode opcode, std::span<const std::uint8_t> content);
  void remember(const McapChannel& channel);
  bool has_channel(const McapMessage& message);
  void read_closing_part();
  void check_data_crc();
  void check_summary_crc();
  void check_end();
  bool read_bytes(std::uint8_t* bytes, std::size_t size);
  void damaged(const std::string& what);
  [[noreturn]] void refuse(std::uint64_t offset, const std::string& what) const;

  std::filesystem::path file_;
  McapDamage damage_;
  std::ifstream stream_;
  std::uint64_t file_bytes_ = 0;
  std::uint64_t offset_ = 0;
  std::uint64_t record_offset_ = 0;
  std::uint32_t crc_ = 0;         ///< of the section's bytes read
  std::uint32_t crc_before_ = 0;  ///< the same before the record read last
  bool crc_known_ = true;         ///< not if records of the section were passed over
  std::vector<std::uint8_t> content_;
  std::vector<std::uint8_t> chunk_;  ///< unpacked
  std::size_t chunk_place_ = 0;      ///< of its next record
  McapHeader header_;
  std::set<std::uint16_t> schema_ids_;
  std::set<std::uint16_t> channel_ids_;
  std::uint64_t message_count_ = 0;
  std::uint64_t skipped_ = 0, undefined_messages_ = 0;
  bool chunked_ = false;            ///< for sure
  std::set<std::uint64_t> places_;  ///< of chunks and what lies beside them, if known
  std::optional<McapStatistics> statistics_;
  bool ended_ = false;
  bool torn_ = false;
};

}  // namespace palpate::recording
