#include "modules/recording/mcap_reader.h"

#include <algorithm>
#include <array>

#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/core/text.h"
#include "modules/recording/mcap_bytes.h"
#include "modules/recording/mcap_chunk.h"
#include "modules/recording/mcap_codec.h"

namespace palpate::recording {
namespace {

std::string in_chunk(std::size_t place, const std::string& what) {
  return "byte " + std::to_string(place) + " of the chunk that begins there: " + what;
}

/// Of kinds that are not used: longer ones are passed over unread.
constexpr std::uint64_t kMostUnusedBytes = 1u << 20;

bool is_used(std::uint8_t opcode) {
  switch (static_cast<McapOpcode>(opcode)) {
    case McapOpcode::kHeader:
    case McapOpcode::kFooter:
    case McapOpcode::kSchema:
    case McapOpcode::kChannel:
    case McapOpcode::kMessage:
    case McapOpcode::kChunk:
    case McapOpcode::kAttachment:
    case McapOpcode::kStatistics:
    case McapOpcode::kMetadata:
    case McapOpcode::kDataEnd:
      return true;
    default:
      return false;
  }
}

/// By the summary.
bool is_indexed(std::uint8_t opcode) {
  const auto kind = static_cast<McapOpcode>(opcode);
  return kind == McapOpcode::kChunk || kind == McapOpcode::kAttachment ||
         kind == McapOpcode::kMetadata;
}

}  // namespace

McapReader::McapReader(const std::filesystem::path& file, McapDamage damage)
    : file_(file), damage_(damage), stream_(open_input(file)) {
  file_bytes_ = std::filesystem::file_size(file);
  std::array<std::uint8_t, kMcapMagic.size()> magic{};
  if (!read_bytes(magic.data(), magic.size()) || magic != kMcapMagic) {
    refuse(0, "not an MCAP file of version 0 (its first bytes are not \\x89MCAP0\\r\\n)");
  }
  offset_ = magic.size();
  std::uint8_t opcode = 0;
  if (!read_envelope(opcode)) return;
  if (opcode != static_cast<std::uint8_t>(McapOpcode::kHeader)) {
    refuse(record_offset_,
           "an MCAP header record must come first, not opcode " + std::to_string(opcode));
  }
  try {
    header_ = parse_header(content_);
  } catch (const McapFieldError& field) {
    refuse(record_offset_, field.what());
  }
}

std::optional<McapRecord> McapReader::next() {
  while (!ended_) {
    auto record = chunk_place_ < chunk_.size() ? next_in_chunk() : next_beside_chunks();
    if (record) return record;
  }
  return std::nullopt;
}

std::optional<McapRecord> McapReader::next_beside_chunks() {
  std::uint8_t opcode = 0;
  if (!read_envelope(opcode)) return std::nullopt;
  try {
    switch (static_cast<McapOpcode>(opcode)) {
      case McapOpcode::kDataEnd:
        damage_ == McapDamage::kSkip ? void(ended_ = true) : read_closing_part();
        return std::nullopt;
      case McapOpcode::kChunk:
        chunk_ = unpacked_chunk(content_);
        chunk_place_ = 0;
        return std::nullopt;
      case McapOpcode::kMessage:
        if (chunked_) throw McapFieldError("a message beside the chunks");
        [[fallthrough]];
      default:
        return parse(static_cast<McapOpcode>(opcode), content_);
    }
  } catch (const McapFieldError& field) {
    damaged(field.what());
    return std::nullopt;
  }
}

std::optional<McapRecord> McapReader::next_in_chunk() {
  const std::size_t place = chunk_place_;
  try {
    ByteReader reader(std::span<const std::uint8_t>(chunk_).subspan(place));
    const auto opcode = static_cast<McapOpcode>(reader.u8());
    const auto content = reader.take(reader.u64());
    chunk_place_ = chunk_.size() - reader.rest().size();
    if (opcode == McapOpcode::kSchema || opcode == McapOpcode::kChannel ||
        opcode == McapOpcode::kMessage) {
      return parse(opcode, content);
    }
    if (static_cast<std::uint8_t>(opcode) < 0x80) throw McapFieldError("no record of a chunk");
  } catch (const McapFieldError& field) {
    chunk_place_ = chunk_.size();
    damaged(in_chunk(place, field.what()));
  }
  return std::nullopt;
}

// Reads one whole record into content_. False, and torn, where the file ends before the record.
bool McapReader::read_envelope(std::uint8_t& opcode) {
  std::uint64_t length = 0;
  for (bool again = true; again;) {
    std::array<std::uint8_t, kMcapEnvelopeBytes> envelope{};
    const std::uint64_t left = file_bytes_ - offset_;
    record_offset_ = offset_;
    crc_before_ = crc_;
    torn_ = ended_ = true;
    if (left < envelope.size() || !read_bytes(envelope.data(), envelope.size())) return false;
    opcode = envelope[0];
    length = ByteReader(std::span(envelope).subspan(1)).u64();
    if (lost_its_way(opcode, length)) continue;
    if (opcode == 0 && damage_ == McapDamage::kSkip) return false;
    if (opcode == 0) refuse(record_offset_, "opcode 0: no MCAP record begins here");
    if (length > left - envelope.size()) return false;
    offset_ += envelope.size() + length;
    again = passes_over(opcode, length);
  }
  content_.resize(length);
  if (!read_bytes(content_.data(), length)) {
    offset_ = record_offset_;
    return false;
  }
  torn_ = ended_ = false;
  return true;
}

/// A damaged length: the record would reach beyond the next one whose place is known, or another
/// kind lies at such a place.
bool McapReader::lost_its_way(std::uint8_t opcode, std::uint64_t length) {
  const auto next = places_.upper_bound(record_offset_);
  if (next == places_.end()) return false;
  const bool reaches_beyond = length > *next - record_offset_ - kMcapEnvelopeBytes;
  const bool another = places_.contains(record_offset_) && !is_indexed(opcode);
  if (opcode != 0 && *next >= record_offset_ + kMcapEnvelopeBytes && !reaches_beyond && !another)
    return false;
  ++skipped_;
  offset_ = *next;
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(offset_));
  return true;
}

bool McapReader::passes_over(std::uint8_t opcode, std::uint64_t length) {
  if (length <= (is_used(opcode) ? kMostRecordBytes : kMostUnusedBytes)) return false;
  if (is_used(opcode)) {
    damaged("a record of " + std::to_string(length) + " bytes; at most " +
            std::to_string(kMostRecordBytes) + " are read");
  }
  stream_.seekg(static_cast<std::streamoff>(length), std::ios::cur);
  crc_known_ = false;
  return true;
}

std::optional<McapRecord> McapReader::parse(McapOpcode opcode,
                                            std::span<const std::uint8_t> content) {
  switch (opcode) {
    case McapOpcode::kSchema: {
      McapSchema schema = parse_schema(content);
      schema_ids_.insert(schema.id);
      return schema;
    }
    case McapOpcode::kChannel: {
      McapChannel channel = parse_channel(content);
      remember(channel);
      return channel;
    }
    case McapOpcode::kMessage: {
      McapMessage message = parse_message(content);
      if (!has_channel(message)) return std::nullopt;
      return message;
    }
    case McapOpcode::kMetadata:
      return parse_metadata(content);
    case McapOpcode::kAttachment:
      return parse_attachment(content);
    case McapOpcode::kHeader:
    case McapOpcode::kFooter:
      throw McapFieldError("a header or footer inside the data section");
    default:
      return std::nullopt;
  }
}

void McapReader::remember(const McapChannel& channel) {
  if (channel.schema_id != 0 && !schema_ids_.contains(channel.schema_id)) {
    throw McapFieldError("channel '" + channel.topic + "' names schema " +
                         std::to_string(channel.schema_id) + ", which was not defined before it");
  }
  channel_ids_.insert(channel.id);
}

bool McapReader::has_channel(const McapMessage& message) {
  const bool defined = channel_ids_.contains(message.channel_id);
  if (!defined && damage_ == McapDamage::kRefuse) {
    throw McapFieldError("message on channel " + std::to_string(message.channel_id) +
                         ", which was not defined before it");
  }
  ++(defined ? message_count_ : undefined_messages_);
  return defined;
}

void McapReader::take(const McapSummary& summary) {
  for (const auto& [id, schema] : summary.schemas) schema_ids_.insert(id);
  for (const auto& [id, channel] : summary.channels) channel_ids_.insert(id);
  places_ = summary.places;
  chunked_ = summary.chunked;
}

// The summary repeats what was read; only its statistics and its being whole matter here.
void McapReader::read_closing_part() {
  check_data_crc();
  crc_ = 0;
  crc_known_ = true;
  std::uint8_t opcode = 0;
  while (read_envelope(opcode)) {
    if (opcode == static_cast<std::uint8_t>(McapOpcode::kStatistics)) {
      statistics_ = parse_statistics(content_);
    }
    if (opcode == static_cast<std::uint8_t>(McapOpcode::kFooter)) {
      check_summary_crc();
      return check_end();
    }
  }
}

void McapReader::check_data_crc() {
  const std::uint32_t stated = ByteReader(content_).u32();
  if (!crc_known_ || stated == 0 || stated == crc_before_) return;
  refuse(record_offset_, "the recording is damaged before this place: its CRC is wrong");
}

// It covers the summary and the footer up to itself.
void McapReader::check_summary_crc() {
  ByteReader footer(content_);
  std::vector<std::uint8_t> covered;
  ByteWriter(covered)
      .u8(static_cast<std::uint8_t>(McapOpcode::kFooter))
      .u64(content_.size())
      .raw(footer.take(kFooterBytes - sizeof(std::uint32_t)));
  const std::uint32_t stated = footer.u32();
  if (!crc_known_ || stated == 0 || stated == crc32(covered, crc_before_)) return;
  refuse(record_offset_, "the summary is damaged: its CRC is wrong");
}

void McapReader::check_end() {
  ended_ = true;
  std::array<std::uint8_t, kMcapMagic.size()> magic{};
  if (!read_bytes(magic.data(), magic.size())) {
    torn_ = true;
    return;
  }
  if (magic != kMcapMagic) refuse(offset_, "the closing magic bytes are wrong");
  offset_ += magic.size();
  if (offset_ != file_bytes_) refuse(offset_, "bytes after the end of the recording");
  if (statistics_ && statistics_->message_count != message_count_) {
    refuse(record_offset_, "the summary counts " + std::to_string(statistics_->message_count) +
                               " messages, the file holds " + std::to_string(message_count_));
  }
}

bool McapReader::read_bytes(std::uint8_t* bytes, std::size_t size) {
  stream_.read(reinterpret_cast<char*>(bytes), static_cast<std::streamsize>(size));
  const auto count = static_cast<std::size_t>(stream_.gcount());
  crc_ = crc32({bytes, count}, crc_);
  return count == size;
}

void McapReader::damaged(const std::string& what) {
  if (damage_ == McapDamage::kRefuse) refuse(record_offset_, what);
  ++skipped_;
}

void McapReader::refuse(std::uint64_t offset, const std::string& what) const {
  throw InputError(file_.string() + ": offset " + std::to_string(offset) + ": " + printable(what));
}

}  // namespace palpate::recording
