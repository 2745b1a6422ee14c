#include "modules/recording/mcap_chunk.h"

#include <zstd.h>

#include <catch2/catch.hpp>

#include "modules/recording/mcap_bytes.h"
#include "modules/recording/mcap_codec.h"

namespace palpate::recording {
namespace {

std::vector<std::uint8_t> chunk_content(std::uint64_t size, std::uint32_t crc,
                                        const std::string& compression,
                                        const std::vector<std::uint8_t>& packed) {
  std::vector<std::uint8_t> content;
  ByteWriter(content)
      .u64(0)
      .u64(0)
      .u64(size)
      .u32(crc)
      .text(compression)
      .u64(packed.size())
      .raw(packed);
  return content;
}

std::vector<std::uint8_t> zstd_of(const std::vector<std::uint8_t>& bytes) {
  std::vector<std::uint8_t> packed(ZSTD_compressBound(bytes.size()));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1));
  return packed;
}

}  // namespace

TEST_CASE("mcap chunk: indexes name the place of every message, by channel") {
  // Oracle: the records at those places of the chunk, unpacked.
  McapChunkBuilder builder;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const McapMessage message{static_cast<std::uint16_t>(1 + i % 3), i, 100 + i, 0, {}};
    builder.add(message, std::vector<std::uint8_t>(i, 0xAB));
  }
  std::vector<std::uint8_t> bytes(5, 0);
  const McapChunkIndex index = builder.finish(1000, bytes);
  CHECK(builder.empty());
  CHECK(index.offset == 1000);
  CHECK(index.message_start_time_ns == 100);
  CHECK(index.message_end_time_ns == 119);
  CHECK(bytes.size() == 5 + index.length + index.message_index_length);
  REQUIRE(index.message_index_offsets.size() == 3);

  const auto record_at = [&](std::uint64_t offset, McapOpcode opcode) {
    ByteReader reader(std::span<const std::uint8_t>(bytes).subspan(5 + offset - 1000));
    REQUIRE(reader.u8() == static_cast<std::uint8_t>(opcode));
    return reader.take(reader.u64());
  };
  const auto records = unpacked_chunk(record_at(1000, McapOpcode::kChunk));
  CHECK(records.size() == index.uncompressed_size);
  std::size_t found = 0;
  for (const auto& [channel, offset] : index.message_index_offsets) {
    ByteReader fields(record_at(offset, McapOpcode::kMessageIndex));
    CHECK(fields.u16() == channel);
    ByteReader places(fields.take(fields.u32()));
    while (!places.rest().empty()) {
      const std::uint64_t time = places.u64();
      ByteReader record(std::span<const std::uint8_t>(records).subspan(places.u64()));
      REQUIRE(record.u8() == static_cast<std::uint8_t>(McapOpcode::kMessage));
      const McapMessage message = parse_message(record.take(record.u64()));
      CHECK(message.channel_id == channel);
      CHECK(message.log_time_ns == time);
      CHECK(message.data.size() == message.sequence);
      ++found;
    }
  }
  CHECK(found == 20);
}

TEST_CASE("mcap chunk: is due after half a second or a megabyte") {
  // Oracle: the two limits that docs/recording.md states.
  McapChunkBuilder builder;
  builder.add({1, 0, 1'000'000'000, 0, {}}, {});
  builder.add({1, 0, 1'499'999'999, 0, {}}, {});
  CHECK_FALSE(builder.due());
  builder.add({1, 0, 1'500'000'000, 0, {}}, {});
  CHECK(builder.due());
  std::vector<std::uint8_t> bytes;
  builder.finish(0, bytes);
  CHECK_FALSE(builder.due());
  builder.add({1, 0, 0, 0, {}}, std::vector<std::uint8_t>(1u << 20));
  CHECK(builder.due());
}

TEST_CASE("mcap chunk: of other writers is read with zstd or none, and refused where it lies") {
  // Oracle: zstd's own encoder; the message of each rule.
  const std::vector<std::uint8_t> records{1, 2, 3, 4, 5, 6, 7};
  const auto packed = zstd_of(records);
  CHECK(unpacked_chunk(chunk_content(7, crc32(records), "zstd", packed)) == records);
  CHECK(unpacked_chunk(chunk_content(7, 0, "zstd", packed)) == records);
  CHECK(unpacked_chunk(chunk_content(7, crc32(records), "", records)) == records);
  CHECK_THROWS_WITH(unpacked_chunk(chunk_content(7, 1, "", records)),
                    "a chunk is damaged: its CRC is wrong");
  CHECK_THROWS_WITH(unpacked_chunk(chunk_content(8, 0, "", records)),
                    "a chunk is not of the size it states");
  CHECK_THROWS_WITH(unpacked_chunk(chunk_content(8, 0, "zstd", packed)),
                    "a chunk's zstd frame is not of the 8 bytes it should be");
  CHECK_THROWS_WITH(unpacked_chunk(chunk_content(7, 0, "lz4", packed)),
                    "a chunk is compressed by 'lz4'; read are zstd and none");
  auto cut = packed;
  cut.pop_back();
  CHECK_THROWS_WITH(unpacked_chunk(chunk_content(7, 0, "zstd", cut)),
                    Catch::StartsWith("a chunk cannot be decompressed: "));
}

TEST_CASE("mcap chunk: a few bytes cannot claim all memory") {
  // Oracle: a bomb: 512 MiB of zeros are 16 kB of zstd.
  const std::uint64_t claimed = 512u << 20;
  const auto bomb = zstd_of(std::vector<std::uint8_t>(1 << 20, 0));
  CHECK_THROWS_WITH(unpacked_chunk(chunk_content(claimed, 0, "zstd", bomb)),
                    "a chunk of 536870912 bytes; at most 268435456 are read");
  CHECK_THROWS_WITH(unpacked_chunk(chunk_content(100, 0, "zstd", bomb)),
                    "a chunk's zstd frame is not of the 100 bytes it should be");
}

}  // namespace palpate::recording
