#include "modules/recording/mcap_codec.h"

#include "modules/recording/mcap_bytes.h"

namespace palpate::recording {
namespace {

constexpr std::size_t kMessageFields = 22;  // bytes before the payload

/// channel u16, number u64, …
void write_by_channel(ByteWriter& writer, const std::map<std::uint16_t, std::uint64_t>& map) {
  writer.u32(static_cast<std::uint32_t>(10 * map.size()));
  for (const auto& [channel, number] : map) writer.u16(channel).u64(number);
}

std::map<std::uint16_t, std::uint64_t> read_by_channel(ByteReader& reader) {
  ByteReader entries(reader.take(reader.u32()));
  std::map<std::uint16_t, std::uint64_t> map;
  while (!entries.rest().empty()) {
    const std::uint16_t channel = entries.u16();
    map[channel] = entries.u64();
  }
  return map;
}

}  // namespace

McapContent content_of(const McapHeader& header) {
  McapContent content;
  ByteWriter(content).text(header.profile).text(header.library);
  return content;
}

McapContent content_of(const McapSchema& schema) {
  McapContent content;
  ByteWriter(content).u16(schema.id).text(schema.name).text(schema.encoding).text(schema.data);
  return content;
}

McapContent content_of(const McapChannel& channel) {
  McapContent content;
  ByteWriter(content)
      .u16(channel.id)
      .u16(channel.schema_id)
      .text(channel.topic)
      .text(channel.message_encoding)
      .text_map(channel.metadata);
  return content;
}

McapContent content_of(const McapMetadata& metadata) {
  McapContent content;
  ByteWriter(content).text(metadata.name).text_map(metadata.entries);
  return content;
}

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

McapContent content_of(const McapChunkIndex& index) {
  McapContent content;
  ByteWriter writer(content);
  writer.u64(index.message_start_time_ns)
      .u64(index.message_end_time_ns)
      .u64(index.offset)
      .u64(index.length);
  write_by_channel(writer, index.message_index_offsets);
  writer.u64(index.message_index_length)
      .text(index.compression)
      .u64(index.compressed_size)
      .u64(index.uncompressed_size);
  return content;
}

McapContent content_of(const McapStatistics& statistics) {
  McapContent content;
  ByteWriter writer(content);
  writer.u64(statistics.message_count)
      .u16(statistics.schema_count)
      .u32(statistics.channel_count)
      .u32(statistics.attachment_count)
      .u32(statistics.metadata_count)
      .u32(statistics.chunk_count)
      .u64(statistics.message_start_time_ns)
      .u64(statistics.message_end_time_ns);
  write_by_channel(writer, statistics.channel_message_counts);
  return content;
}

void append_record(std::vector<std::uint8_t>& bytes, McapOpcode opcode,
                   std::span<const std::uint8_t> content) {
  ByteWriter(bytes).u8(static_cast<std::uint8_t>(opcode)).u64(content.size()).raw(content);
}

void append_message(std::vector<std::uint8_t>& bytes, const McapMessage& message,
                    std::span<const std::uint8_t> data) {
  ByteWriter(bytes)
      .u8(static_cast<std::uint8_t>(McapOpcode::kMessage))
      .u64(kMessageFields + data.size())
      .u16(message.channel_id)
      .u32(message.sequence)
      .u64(message.log_time_ns)
      .u64(message.publish_time_ns)
      .raw(data);
}

McapHeader parse_header(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  McapHeader header;
  header.profile = reader.text();
  header.library = reader.text();
  return header;
}

McapSchema parse_schema(std::span<const std::uint8_t> content) {
  if (content.size() > kMostSchemaBytes) {
    throw McapFieldError("a schema of " + std::to_string(content.size()) + " bytes; at most " +
                         std::to_string(kMostSchemaBytes) + " are read");
  }
  ByteReader reader(content);
  McapSchema schema;
  schema.id = reader.u16();
  if (schema.id == 0) throw McapFieldError("schema id 0 is not allowed");
  schema.name = reader.text();
  schema.encoding = reader.text();
  schema.data = reader.text();
  return schema;
}

McapChannel parse_channel(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  McapChannel channel;
  channel.id = reader.u16();
  channel.schema_id = reader.u16();
  channel.topic = reader.text();
  channel.message_encoding = reader.text();
  channel.metadata = reader.text_map();
  return channel;
}

McapMessage parse_message(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  McapMessage message;
  message.channel_id = reader.u16();
  message.sequence = reader.u32();
  message.log_time_ns = reader.u64();
  message.publish_time_ns = reader.u64();
  message.data.assign(reader.rest().begin(), reader.rest().end());
  return message;
}

McapMetadata parse_metadata(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  McapMetadata metadata;
  metadata.name = reader.text();
  metadata.entries = reader.text_map();
  return metadata;
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
  ByteReader reader(content);
  McapChunkIndex index;
  index.message_start_time_ns = reader.u64();
  index.message_end_time_ns = reader.u64();
  index.offset = reader.u64();
  index.length = reader.u64();
  index.message_index_offsets = read_by_channel(reader);
  index.message_index_length = reader.u64();
  index.compression = reader.text();
  index.compressed_size = reader.u64();
  index.uncompressed_size = reader.u64();
  return index;
}

McapStatistics parse_statistics(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  McapStatistics statistics;
  statistics.message_count = reader.u64();
  statistics.schema_count = reader.u16();
  statistics.channel_count = reader.u32();
  statistics.attachment_count = reader.u32();
  statistics.metadata_count = reader.u32();
  statistics.chunk_count = reader.u32();
  statistics.message_start_time_ns = reader.u64();
  statistics.message_end_time_ns = reader.u64();
  statistics.channel_message_counts = read_by_channel(reader);
  return statistics;
}

}  // namespace palpate::recording
