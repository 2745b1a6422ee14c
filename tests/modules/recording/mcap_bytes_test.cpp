#include "modules/recording/mcap_bytes.h"

#include <catch2/catch.hpp>

namespace palpate::recording {

TEST_CASE("mcap bytes: numbers are little-endian, texts and maps begin with their length") {
  // Oracle: bytes written by hand from the specification.
  std::vector<std::uint8_t> bytes;
  ByteWriter(bytes).u8(1).u16(0x0302).u32(0x07060504).u64(0x0F0E0D0C0B0A0908).text("ab");
  ByteWriter(bytes).text_map({{"k", "vw"}});
  const std::vector<std::uint8_t> expected{
      1,  2, 3, 4, 5, 6, 7, 8, 9,   10, 11, 12, 13, 14,  15, 2, 0, 0, 0, 'a', 'b',  // text
      11, 0, 0, 0, 1, 0, 0, 0, 'k', 2,  0,  0,  0,  'v', 'w'};
  CHECK(bytes == expected);
}

TEST_CASE("mcap bytes: the reader takes what the writer put") {
  // Oracle: round trip.
  std::vector<std::uint8_t> bytes;
  ByteWriter(bytes).u8(0xFF).u16(0xFFFE).u32(0xFFFFFFFD).u64(~std::uint64_t{3}).text("");
  ByteWriter(bytes).text_map({{"a", ""}, {"", "b"}});
  ByteReader reader(bytes);
  CHECK(reader.u8() == 0xFF);
  CHECK(reader.u16() == 0xFFFE);
  CHECK(reader.u32() == 0xFFFFFFFD);
  CHECK(reader.u64() == ~std::uint64_t{3});
  CHECK(reader.text().empty());
  CHECK(reader.text_map() == McapMap{{"a", ""}, {"", "b"}});
  CHECK(reader.rest().empty());
}

TEST_CASE("mcap bytes: a field that reaches beyond its record is refused") {
  // Oracle: the message the rule must give.
  const std::vector<std::uint8_t> bytes{9, 0, 0, 0, 'x'};
  CHECK_THROWS_WITH(ByteReader(bytes).text(), "a field of 9 bytes where 1 are left of the record");
  CHECK_THROWS_AS(ByteReader(bytes).u64(), McapFieldError);
  CHECK_THROWS_AS(ByteReader(bytes).text_map(), McapFieldError);
}

}  // namespace palpate::recording
