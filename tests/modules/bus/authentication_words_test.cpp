#include "modules/bus/authentication_words.h"

#include <catch2/catch.hpp>

#include "tests/modules/bus/rtps_packets.h"

namespace palpate::bus {
namespace {

using testing::Bytes;
using testing::Content;

constexpr std::size_t kCountAt = 4 + 96 + 12;  // of data holders, behind the class "abcd"

/// Little-endian: one data holder of a property and two binary ones, the last without octets.
Bytes generic_message(std::uint32_t holders = 1, const Bytes& class_end = {0, 0, 0, 0}) {
  const Bytes text{3, 0, 0, 0, 'p', 'q', 0, 0};
  return Content()
      .raw({0, 3, 0, 0})
      .raw(Bytes(96))
      .raw({5, 0, 0, 0, 'a', 'b', 'c', 'd'})
      .raw(class_end)
      .four(holders)
      .raw(text)
      .four(1)
      .raw(text)
      .raw(text)
      .four(2)
      .raw(text)
      .raw({2, 0, 0, 0, 8, 9, 0, 0})
      .raw(text)
      .four(0)
      .bytes();
}

}  // namespace

TEST_CASE("authentication words: a message of which nothing is missing is one", "[bus]") {
  // Oracle: DDS Security 1.1, section 7.4.3.3, by hand; that real ones are shows the test of keys.
  const Bytes whole = generic_message();
  CHECK(is_generic_message(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    INFO(size << " bytes");
    CHECK_FALSE(is_generic_message(std::span(whole).first(size)));
  }
}

TEST_CASE("authentication words: lists longer than the message are none", "[bus]") {
  // Oracle: the counts. Of the first, Fast DDS 2.9.1 makes room for 4 billion parts, and ends.
  for (const std::uint32_t holders : {2u, 1'000u, 0x7fff'ffffu, 0xffff'ffffu}) {
    CHECK_FALSE(is_generic_message(generic_message(holders)));
  }
  const Bytes whole = generic_message();
  for (std::size_t at = kCountAt; at + 4 <= whole.size(); at += 4) {
    Bytes longer = whole;
    longer[at + 3] = 0x80;
    INFO("at byte " << at);
    const bool is_text = whole[at] >= 'a' || whole[at] == 8;
    CHECK(is_generic_message(longer) == is_text);
  }
  CHECK_FALSE(is_generic_message(generic_message(1, {'e', 0, 0, 0})));  // a text without an end
}

}  // namespace palpate::bus
