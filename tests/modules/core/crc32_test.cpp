#include "modules/core/crc32.h"

#include <catch2/catch.hpp>
#include <vector>

namespace palpate {

TEST_CASE("crc32: the one of zlib, gzip and MCAP") {
  // Oracle: the published check value of CRC-32 for the text "123456789".
  const std::vector<std::uint8_t> bytes{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  CHECK(crc32(bytes) == 0xCBF43926u);
  CHECK(crc32({}) == 0);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    const std::span all(bytes);
    CHECK(crc32(all.subspan(cut), crc32(all.first(cut))) == 0xCBF43926u);
  }
}

}  // namespace palpate
