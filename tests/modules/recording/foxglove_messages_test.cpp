#include "modules/recording/foxglove_messages.h"

#include <bit>
#include <catch2/catch.hpp>
#include <cstring>

namespace palpate::recording {
namespace {

template <class Number>
Number number_at(const foxglove::Payload& payload, std::size_t place) {
  Number value;
  std::memcpy(&value, payload.data() + place, sizeof value);
  return value;
}

}  // namespace

TEST_CASE("foxglove messages: numbers lie where plain CDR has them") {
  // Oracle: CDR by hand: 4 bytes of encapsulation, from there each number at a multiple of its
  // size.
  const auto payload =
      foxglove::pose_in_frame(3'000'000'007, "world", {{1, -2, 0.5}, Quat(0.5, 0.5, -0.5, 0.5)});
  CHECK(number_at<std::uint32_t>(payload, 0) == 0x0100);  // bytes 0, 1: little endian
  CHECK(number_at<std::uint32_t>(payload, 4) == 3);
  CHECK(number_at<std::uint32_t>(payload, 8) == 7);
  CHECK(number_at<std::uint32_t>(payload, 12) == 6);  // "world" and its end
  CHECK(std::string(reinterpret_cast<const char*>(payload.data()) + 16) == "world");
  CHECK(number_at<double>(payload, 4 + 24) == 1);  // 12 + 4 + 6 bytes, up to a multiple of 8
  CHECK(number_at<double>(payload, 4 + 24 + 8) == -2);
  CHECK(number_at<double>(payload, 4 + 48) == 0.5);       // x of the rotation
  CHECK(number_at<double>(payload, 4 + 48 + 8) == -0.5);  // y
  CHECK(number_at<double>(payload, 4 + 48 + 24) == 0.5);  // w
  CHECK(payload.size() == 4 + 24 + 7 * 8);
}

TEST_CASE("foxglove messages: each type has its IDL, Foxglove's in its module") {
  // Oracle: the names under which Foxglove looks for them.
  for (const std::string_view type : foxglove::kTypes) {
    const std::string idl = foxglove::idl_of(type);
    INFO(type);
    CHECK_THAT(idl,
               Catch::Contains("struct " + std::string(type.substr(type.rfind(':') + 1)) + " {"));
    CHECK_THAT(idl, Catch::StartsWith("module foxglove {"));
  }
}

}  // namespace palpate::recording
