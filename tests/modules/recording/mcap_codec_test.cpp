#include "modules/recording/mcap_codec.h"

#include <catch2/catch.hpp>

#include "modules/recording/mcap_bytes.h"

namespace palpate::recording {

TEST_CASE("mcap codec: what is written is read back") {
  // Oracle: round trip of values that all differ.
  const auto header = parse_header(content_of(McapHeader{"p", "l"}));
  CHECK(header.profile == "p");
  CHECK(header.library == "l");
  const auto schema = parse_schema(content_of(McapSchema{7, "n", "e", "d"}));
  CHECK(schema.id == 7);
  CHECK(schema.name + schema.encoding + schema.data == "ned");
  const auto channel = parse_channel(content_of(McapChannel{3, 7, "t", "cdr", {{"k", "v"}}}));
  CHECK(channel.id == 3);
  CHECK(channel.schema_id == 7);
  CHECK(channel.topic + channel.message_encoding == "tcdr");
  CHECK(channel.metadata == McapMap{{"k", "v"}});
  const auto metadata = parse_metadata(content_of(McapMetadata{"m", {{"a", "b"}}}));
  CHECK(metadata.name == "m");
  CHECK(metadata.entries == McapMap{{"a", "b"}});
  const auto attachment = parse_attachment(content_of(McapAttachment{5, "a", "text/plain", "xyz"}));
  CHECK(attachment.log_time_ns == 5);
  CHECK(attachment.name + attachment.media_type + attachment.data == "atext/plainxyz");
  const auto index = parse_chunk_index(
      content_of(McapChunkIndex{1, 2, 3, 4, {{5, 6}, {7, 8}}, 9, "zstd", 10, 11}));
  CHECK(index.message_start_time_ns == 1);
  CHECK(index.message_end_time_ns == 2);
  CHECK(index.offset == 3);
  CHECK(index.length == 4);
  CHECK(index.message_index_offsets == std::map<std::uint16_t, std::uint64_t>{{5, 6}, {7, 8}});
  CHECK(index.message_index_length == 9);
  CHECK(index.compression == "zstd");
  CHECK(index.compressed_size == 10);
  CHECK(index.uncompressed_size == 11);
  const auto statistics =
      parse_statistics(content_of(McapStatistics{1, 2, 3, 4, 5, 6, 7, 8, {{9, 10}}}));
  CHECK(statistics.message_count == 1);
  CHECK(statistics.attachment_count == 4);
  CHECK(statistics.chunk_count == 6);
  CHECK(statistics.message_end_time_ns == 8);
  CHECK(statistics.channel_message_counts == std::map<std::uint16_t, std::uint64_t>{{9, 10}});
}

TEST_CASE("mcap codec: a message's record is read back") {
  // Oracle: round trip; the record's length by the specification's table.
  std::vector<std::uint8_t> record;
  const std::vector<std::uint8_t> payload{7, 8};
  append_message(record, {1, 2, 3, 4, {}}, payload);
  REQUIRE(record.size() == kMcapEnvelopeBytes + 2 + 4 + 8 + 8 + 2);
  const auto message = parse_message(std::span(record).subspan(kMcapEnvelopeBytes));
  CHECK(message.channel_id == 1);
  CHECK(message.sequence == 2);
  CHECK(message.log_time_ns == 3);
  CHECK(message.publish_time_ns == 4);
  CHECK(message.data == payload);
}

TEST_CASE("mcap codec: contents cut anywhere are refused, a changed attachment too") {
  // Oracle: every prefix of a content lacks a field.
  const McapContent whole = content_of(McapAttachment{5, "a", "text/plain", "xyz"});
  for (std::size_t cut = 0; cut < whole.size(); ++cut) {
    CHECK_THROWS_AS(parse_attachment(std::span(whole).first(cut)), McapFieldError);
  }
  McapContent changed = whole;
  changed[whole.size() - 5] ^= 1;
  CHECK_THROWS_WITH(parse_attachment(changed), "the attachment 'a' is damaged: its CRC is wrong");
}

TEST_CASE("mcap codec: a schema of more than a mebibyte is refused") {
  // Oracle: the bound, met and passed by one byte: id, and three texts with their lengths.
  const std::size_t rest = 2 + 3 * 4;
  McapSchema schema{1, "", "", std::string(kMostSchemaBytes - rest, 'x')};
  CHECK(parse_schema(content_of(schema)).data == schema.data);
  schema.data += 'x';
  CHECK_THROWS_WITH(parse_schema(content_of(schema)),
                    "a schema of 1048577 bytes; at most 1048576 are read");
}

}  // namespace palpate::recording
