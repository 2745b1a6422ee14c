#include "modules/recording/mcap_codec.h"

#include <concepts>

#include "modules/recording/mcap_bytes.h"

namespace palpate::recording {
namespace {

using ByChannel = std::map<std::uint16_t, std::uint64_t>;  ///< as a map of the container

/// Writes fields one after the other.
struct FieldWriter {
  ByteWriter& bytes;

  void operator()(const auto&... fields) const { (put(fields), ...); }
  void put(std::uint16_t number) const { bytes.u16(number); }
  void put(std::uint32_t number) const { bytes.u32(number); }
  void put(std::uint64_t number) const { bytes.u64(number); }
  void put(const std::string& text) const { bytes.text(text); }
  void put(const McapMap& map) const { bytes.text_map(map); }
  void put(const ByChannel& map) const {
    bytes.u32(static_cast<std::uint32_t>(10 * map.size()));
    for (const auto& [channel, number] : map) bytes.u16(channel).u64(number);
  }
};

/// Reads them back.
struct FieldReader {
  ByteReader& bytes;

  void operator()(auto&... fields) const { (take(fields), ...); }
  void take(std::uint16_t& number) const { number = bytes.u16(); }
  void take(std::uint32_t& number) const { number = bytes.u32(); }
  void take(std::uint64_t& number) const { number = bytes.u64(); }
  void take(std::string& text) const { text = bytes.text(); }
  void take(McapMap& map) const { map = bytes.text_map(); }
  void take(ByChannel& map) const {
    ByteReader entries(bytes.take(bytes.u32()));
    while (!entries.rest().empty()) {
      const std::uint16_t channel = entries.u16();
      map[channel] = entries.u64();
    }
  }
};

/// M, to be written, or read into.
template <class T, class M>
concept Is = std::same_as<std::remove_const_t<T>, M>;

void fields(const auto& each, Is<McapHeader> auto& m) { each(m.profile, m.library); }

void fields(const auto& each, Is<McapSchema> auto& m) { each(m.id, m.name, m.encoding, m.data); }

void fields(const auto& each, Is<McapChannel> auto& m) {
  each(m.id, m.schema_id, m.topic, m.message_encoding, m.metadata);
}

/// All but its payload.
void fields(const auto& each, Is<McapMessage> auto& m) {
  each(m.channel_id, m.sequence, m.log_time_ns, m.publish_time_ns);
}

void fields(const auto& each, Is<McapMetadata> auto& m) { each(m.name, m.entries); }

void fields(const auto& each, Is<McapChunkIndex> auto& m) {
  each(m.message_start_time_ns, m.message_end_time_ns, m.offset, m.length, m.message_index_offsets,
       m.message_index_length, m.compression, m.compressed_size, m.uncompressed_size);
}

void fields(const auto& each, Is<McapStatistics> auto& m) {
  each(m.message_count, m.schema_count, m.channel_count, m.attachment_count, m.metadata_count,
       m.chunk_count, m.message_start_time_ns, m.message_end_time_ns, m.channel_message_counts);
}

template <class M>
McapContent written(const M& record) {
  McapContent content;
  ByteWriter writer(content);
  fields(FieldWriter{writer}, record);
  return content;
}

template <class M>
M read(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  M record;
  fields(FieldReader{reader}, record);
  return record;
}

}  // namespace

McapContent content_of(const McapHeader& header) { return written(header); }
McapContent content_of(const McapSchema& schema) { return written(schema); }
McapContent content_of(const McapChannel& channel) { return written(channel); }
McapContent content_of(const McapMetadata& metadata) { return written(metadata); }
McapContent content_of(const McapChunkIndex& index) { return written(index); }
McapContent content_of(const McapStatistics& statistics) { return written(statistics); }

McapContent content_of(const McapAttachment& attachment) {
  McapContent content;
  ByteWriter writer(content);
  writer.u64(attachment.log_time_ns)
      .u64(0)  // when the file was made: not known
      .text(attachment.name)
      .text(attachment.media_type)
      .u64(attachment.data.size())
      .raw({reinterpret_cast<const std::uint8_t*>(attachment.data.data()), attachment.data.size()});
  writer.u32(crc32(content));
  return content;
}

void append_record(std::vector<std::uint8_t>& bytes, McapOpcode opcode,
                   std::span<const std::uint8_t> content) {
  ByteWriter(bytes).u8(static_cast<std::uint8_t>(opcode)).u64(content.size()).raw(content);
}

void append_message(std::vector<std::uint8_t>& bytes, const McapMessage& message,
                    std::span<const std::uint8_t> data) {
  constexpr std::size_t kFieldBytes = 22;  // before the payload
  ByteWriter writer(bytes);
  writer.u8(static_cast<std::uint8_t>(McapOpcode::kMessage)).u64(kFieldBytes + data.size());
  fields(FieldWriter{writer}, message);
  writer.raw(data);
}

McapHeader parse_header(std::span<const std::uint8_t> content) { return read<McapHeader>(content); }

McapSchema parse_schema(std::span<const std::uint8_t> content) {
  if (content.size() > kMostSchemaBytes) {
    throw McapFieldError("a schema of " + std::to_string(content.size()) + " bytes; at most " +
                         std::to_string(kMostSchemaBytes) + " are read");
  }
  auto schema = read<McapSchema>(content);
  if (schema.id == 0) throw McapFieldError("schema id 0 is not allowed");
  return schema;
}

McapChannel parse_channel(std::span<const std::uint8_t> content) {
  return read<McapChannel>(content);
}

McapMessage parse_message(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  McapMessage message;
  fields(FieldReader{reader}, message);
  message.data.assign(reader.rest().begin(), reader.rest().end());
  return message;
}

McapMetadata parse_metadata(std::span<const std::uint8_t> content) {
  return read<McapMetadata>(content);
}

McapAttachment parse_attachment(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  McapAttachment attachment;
  attachment.log_time_ns = reader.u64();
  reader.u64();  // when it was made
  attachment.name = reader.text();
  attachment.media_type = reader.text();
  const auto data = reader.take(reader.u64());
  attachment.data.assign(data.begin(), data.end());
  const std::size_t covered = content.size() - reader.rest().size();
  const std::uint32_t crc = reader.u32();
  if (crc != 0 && crc != crc32(content.first(covered))) {
    throw McapFieldError("the attachment '" + attachment.name + "' is damaged: its CRC is wrong");
  }
  return attachment;
}

McapChunkIndex parse_chunk_index(std::span<const std::uint8_t> content) {
  return read<McapChunkIndex>(content);
}

McapStatistics parse_statistics(std::span<const std::uint8_t> content) {
  return read<McapStatistics>(content);
}

}  // namespace palpate::recording
