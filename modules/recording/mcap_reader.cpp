#include "modules/recording/mcap_reader.h"

#include <algorithm>
#include <array>

#include "modules/core/error.h"
#include "modules/recording/mcap_bytes.h"

namespace palpate::recording {
namespace {

McapStatistics parse_statistics(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  McapStatistics statistics;
  statistics.message_count = reader.u64();
  statistics.schema_count = reader.u16();
  statistics.channel_count = reader.u32();
  reader.u32();  // attachments
  statistics.metadata_count = reader.u32();
  reader.u32();  // chunks
  statistics.message_start_time_ns = reader.u64();
  statistics.message_end_time_ns = reader.u64();
  ByteReader counts(reader.take(reader.u32()));
  while (!counts.rest().empty()) {
    const std::uint16_t channel = counts.u16();
    statistics.channel_message_counts[channel] = counts.u64();
  }
  return statistics;
}

McapSchema parse_schema(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  McapSchema schema;
  schema.id = reader.u16();
  if (schema.id == 0) throw McapFieldError("schema id 0 is not allowed");
  schema.name = reader.text();
  schema.encoding = reader.text();
  schema.data = reader.text();
  return schema;
}

McapMetadata parse_metadata(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  McapMetadata metadata;
  metadata.name = reader.text();
  metadata.entries = reader.text_map();
  return metadata;
}

}  // namespace

McapReader::McapReader(const std::filesystem::path& file) : file_(file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw InputError(file.string() + ": no such recording");
  }
  file_bytes_ = std::filesystem::file_size(file, error);
  stream_.open(file, std::ios::binary);
  if (!stream_ || error) throw InputError(file.string() + ": cannot be read");

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
    ByteReader reader(content_);
    header_.profile = reader.text();
    header_.library = reader.text();
  } catch (const McapFieldError& field) {
    refuse(record_offset_, field.what());
  }
}

std::optional<McapRecord> McapReader::next() {
  std::uint8_t opcode = 0;
  while (!ended_ && read_envelope(opcode)) {
    if (opcode == static_cast<std::uint8_t>(McapOpcode::kDataEnd)) {
      read_closing_part();
      break;
    }
    try {
      if (auto record = parse(static_cast<McapOpcode>(opcode))) return record;
    } catch (const McapFieldError& field) {
      refuse(record_offset_, field.what());
    }
  }
  return std::nullopt;
}

// Reads one whole record into content_. False, and torn, where the file ends before the record.
bool McapReader::read_envelope(std::uint8_t& opcode) {
  std::array<std::uint8_t, kMcapEnvelopeBytes> envelope{};
  const std::uint64_t left = file_bytes_ - offset_;
  record_offset_ = offset_;
  torn_ = ended_ = true;
  if (left < envelope.size() || !read_bytes(envelope.data(), envelope.size())) return false;
  opcode = envelope[0];
  const std::uint64_t length = ByteReader(std::span(envelope).subspan(1)).u64();
  if (opcode == 0) refuse(record_offset_, "opcode 0: no MCAP record begins here");
  if (length > left - envelope.size()) return false;
  content_.resize(length);
  if (!read_bytes(content_.data(), length)) return false;
  offset_ += envelope.size() + length;
  torn_ = ended_ = false;
  return true;
}

std::optional<McapRecord> McapReader::parse(McapOpcode opcode) {
  switch (opcode) {
    case McapOpcode::kSchema: {
      McapSchema schema = parse_schema(content_);
      schema_ids_.insert(schema.id);
      return schema;
    }
    case McapOpcode::kChannel:
      return parse_channel();
    case McapOpcode::kMessage:
      return parse_message();
    case McapOpcode::kMetadata:
      return parse_metadata(content_);
    case McapOpcode::kChunk:
      refuse(record_offset_, "chunked MCAP files are not read here");
    case McapOpcode::kHeader:
    case McapOpcode::kFooter:
      refuse(record_offset_, "a header or footer inside the data section");
    default:
      return std::nullopt;
  }
}

McapChannel McapReader::parse_channel() {
  ByteReader reader(content_);
  McapChannel channel;
  channel.id = reader.u16();
  channel.schema_id = reader.u16();
  channel.topic = reader.text();
  channel.message_encoding = reader.text();
  channel.metadata = reader.text_map();
  if (channel.schema_id != 0 && !schema_ids_.contains(channel.schema_id)) {
    throw McapFieldError("channel '" + channel.topic + "' names schema " +
                         std::to_string(channel.schema_id) + ", which was not defined before it");
  }
  channel_ids_.insert(channel.id);
  return channel;
}

McapMessage McapReader::parse_message() {
  ByteReader reader(content_);
  McapMessage message;
  message.channel_id = reader.u16();
  message.sequence = reader.u32();
  message.log_time_ns = reader.u64();
  message.publish_time_ns = reader.u64();
  message.data.assign(reader.rest().begin(), reader.rest().end());
  if (!channel_ids_.contains(message.channel_id)) {
    throw McapFieldError("message on channel " + std::to_string(message.channel_id) +
                         ", which was not defined before it");
  }
  ++message_count_;
  return message;
}

// The summary repeats what was read; only its statistics and its being whole matter here.
void McapReader::read_closing_part() {
  std::uint8_t opcode = 0;
  while (read_envelope(opcode)) {
    try {
      if (opcode == static_cast<std::uint8_t>(McapOpcode::kStatistics)) {
        statistics_ = parse_statistics(content_);
      }
    } catch (const McapFieldError& field) {
      refuse(record_offset_, field.what());
    }
    if (opcode == static_cast<std::uint8_t>(McapOpcode::kFooter)) return check_footer();
  }
}

void McapReader::check_footer() {
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
  return static_cast<std::size_t>(stream_.gcount()) == size;
}

void McapReader::refuse(std::uint64_t offset, const std::string& what) const {
  throw InputError(file_.string() + ": offset " + std::to_string(offset) + ": " + what);
}

}  // namespace palpate::recording
