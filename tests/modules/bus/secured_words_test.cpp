#include "modules/bus/secured_words.h"

#include <catch2/catch.hpp>

#include "tests/modules/bus/rtps_packets.h"

namespace palpate::bus {
namespace {

using testing::Bytes;
using testing::Content;
using testing::submessage;

const Bytes kFront = submessage(0x31, 1, Content().raw(Bytes(20)));
const Bytes kBehind = submessage(0x32, 1, Content().raw(Bytes(20)));
const Bytes kPlainWord = testing::timestamp();

Bytes body_of(const Bytes& length, std::size_t bytes) {
  return submessage(0x30, 1, Content().raw(length).raw(Bytes(bytes)));
}

bool sound(std::initializer_list<Bytes> words) {
  SecuredWords secured;
  for (const Bytes& word : words) {
    if (!secured.follows(word)) return false;
  }
  return secured.complete();
}

}  // namespace

TEST_CASE("secured words: three in their order, as often as one likes", "[bus]") {
  // Oracle: DDS Security 1.1, section 7.3.6.
  const Bytes body = body_of({0, 0, 0, 8}, 8);
  CHECK(sound({}));
  CHECK(sound({kFront, body, kBehind}));
  CHECK(sound({kPlainWord, kFront, body, kBehind, kFront, body, kBehind, kPlainWord}));
  CHECK_FALSE(sound({kFront}));
  CHECK_FALSE(sound({kFront, body}));
  CHECK_FALSE(sound({body, kBehind}));
  CHECK_FALSE(sound({kBehind}));
  CHECK_FALSE(sound({kFront, kBehind}));
  CHECK_FALSE(sound({kFront, body, body, kBehind}));
  CHECK_FALSE(sound({kFront, kPlainWord, body, kBehind}));
  CHECK_FALSE(sound({kFront, body, kPlainWord, kBehind}));
  CHECK_FALSE(sound({kFront, kFront, body, kBehind}));
}

TEST_CASE("secured words: what they say they hold is there", "[bus]") {
  // Oracle: lengths by hand, big-endian; a body is padded to four bytes at most.
  const auto with_body = [](const Bytes& length, std::size_t bytes) {
    return sound({kFront, body_of(length, bytes), kBehind});
  };
  CHECK(with_body({0, 0, 0, 7}, 7));
  CHECK(with_body({0, 0, 0, 7}, 8));
  CHECK(with_body({0, 0, 1, 0}, 256));
  CHECK_FALSE(with_body({0, 0, 0, 7}, 9));
  CHECK_FALSE(with_body({0, 0, 0, 9}, 8));
  CHECK_FALSE(with_body({8, 0, 0, 0}, 8));
  CHECK_FALSE(with_body({0xff, 0xff, 0xff, 0xff}, 8));
  CHECK_FALSE(with_body({0, 0, 0, 0}, 0));
  CHECK_FALSE(sound({kFront, submessage(0x30, 1, Content().raw({0, 0, 0})), kBehind}));
  const Bytes body = body_of({0, 0, 0, 8}, 8);
  const auto with_codes = [&](const Bytes& receivers, std::size_t bytes) {
    return sound({kFront, body,
                  submessage(0x32, 1, Content().raw(Bytes(16)).raw(receivers).raw(Bytes(bytes)))});
  };
  CHECK(with_codes({0, 0, 0, 2}, 40));
  CHECK_FALSE(with_codes({0, 0, 0, 2}, 20));
  CHECK_FALSE(with_codes({0, 0, 0, 0}, 20));
  CHECK_FALSE(with_codes({0xff, 0xff, 0xff, 0xff}, 20));
  CHECK_FALSE(with_codes({0, 0, 0}, 0));
  CHECK_FALSE(sound({submessage(0x31, 1, Content().raw(Bytes(24))), body, kBehind}));
}

TEST_CASE("secured words: one order of bytes, and no length that means the rest", "[bus]") {
  // Oracle: what our own writers send.
  const Bytes body = body_of({0, 0, 0, 8}, 8);
  Bytes big = kFront, rest = kBehind;
  big[1] = 0;
  rest[2] = 0;
  CHECK_FALSE(sound({big, body, kBehind}));
  CHECK_FALSE(sound({kFront, body, rest}));
}

}  // namespace palpate::bus
