// RTPS packets by hand, sound and not, after RTPS 2.5 (formal/22-04-01, section 9.4.5).
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

namespace palpate::bus::testing {

using Bytes = std::vector<std::uint8_t>;

/// Little-endian content, one thing after the other.
class Content {
 public:
  template <class Number>
  Content& number(Number value) {
    for (std::size_t i = 0; i < sizeof value; ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> 8 * i));
    }
    return *this;
  }
  Content& two(std::uint16_t value) { return number(value); }
  Content& four(std::uint32_t value) { return number(value); }
  Content& entity(std::uint32_t id) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes_.push_back(std::uint8_t(id >> shift));
    return *this;
  }
  Content& sequence(std::int64_t value) {
    return four(static_cast<std::uint32_t>(value >> 32)).four(static_cast<std::uint32_t>(value));
  }
  Content& set(std::int64_t base, std::uint32_t bits) {
    sequence(base).four(bits);
    return raw(Bytes((bits + 31) / 32 * 4));
  }
  Content& raw(const Bytes& bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

inline const Bytes kSomebody{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
inline const Bytes kSomebodyElse{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 13};

inline Bytes header(const Bytes& prefix = kSomebody) {
  Bytes bytes{'R', 'T', 'P', 'S', 2, 3, 1, 15};
  bytes.insert(bytes.end(), prefix.begin(), prefix.end());
  return bytes;
}

inline Bytes submessage(std::uint8_t kind, std::uint8_t flags, const Content& content) {
  return Content()
      .number(kind)
      .number(flags)
      .two(static_cast<std::uint16_t>(content.bytes().size()))
      .raw(content.bytes())
      .bytes();
}

inline Bytes joined(std::initializer_list<Bytes> parts) {
  Content all;
  for (const Bytes& part : parts) all.raw(part);
  return all.bytes();
}

constexpr std::uint32_t kUserWriter = 0x00000102, kUserReader = 0x00000107;
constexpr std::uint32_t kAnnouncer = 0x000100c2;

inline Bytes data(std::uint32_t writer, std::int64_t sequence, const Bytes& payload) {
  return submessage(
      0x15, 5, Content().two(0).two(16).entity(0).entity(writer).sequence(sequence).raw(payload));
}
/// A participant's announcement: its GUID and the end of the list.
inline Bytes announcement(const Bytes& prefix) {
  return data(kAnnouncer, 1,
              Content()
                  .number(std::uint32_t{0x300})
                  .two(0x50)
                  .two(16)
                  .raw(prefix)
                  .entity(0x1c1)
                  .two(1)
                  .two(0)
                  .bytes());
}
/// A participant's farewell: nothing but the key in the inline QoS, and that it is disposed of.
inline Bytes farewell(const Bytes& prefix) {
  return submessage(0x15, 3,
                    Content()
                        .two(0)
                        .two(16)
                        .entity(0)
                        .entity(kAnnouncer)
                        .sequence(2)
                        .two(0x70)
                        .two(16)
                        .raw(prefix)
                        .entity(0x1c1)
                        .two(0x71)
                        .two(4)
                        .raw({0, 0, 0, 3})
                        .two(1)
                        .two(0));
}
inline Bytes data_frag(std::int64_t sequence, std::uint32_t first, std::uint16_t count,
                       std::uint16_t size, std::uint32_t sample, const Bytes& payload) {
  return submessage(0x16, 1,
                    Content()
                        .two(0)
                        .two(28)
                        .entity(0)
                        .entity(kUserWriter)
                        .sequence(sequence)
                        .four(first)
                        .two(count)
                        .two(size)
                        .four(sample)
                        .raw(payload));
}
inline Bytes gap(std::int64_t start, std::int64_t base, std::uint32_t bits = 0) {
  return submessage(
      8, 1, Content().entity(kUserReader).entity(kUserWriter).sequence(start).set(base, bits));
}
inline Bytes heartbeat(std::int64_t first, std::int64_t last) {
  return submessage(
      7, 1,
      Content().entity(kUserReader).entity(kUserWriter).sequence(first).sequence(last).four(1));
}
inline Bytes acknack(std::int64_t base, std::uint32_t bits) {
  return submessage(6, 1,
                    Content().entity(kUserReader).entity(kUserWriter).set(base, bits).four(1));
}
inline Bytes timestamp() { return submessage(9, 1, Content().four(1).four(2)); }
/// An encrypted sub-message of so many bytes, with one code for all who read it.
inline Bytes secured_word(std::uint8_t bytes = 96) {
  return joined({submessage(0x31, 1, Content().raw(Bytes(20))),
                 submessage(0x30, 1, Content().raw({0, 0, 0, bytes}).raw(Bytes(bytes))),
                 submessage(0x32, 1, Content().raw(Bytes(20)))});
}
/// What Fast DDS 2.9.1 ends every packet with.
inline Bytes statistics() { return submessage(0x80, 1, Content().raw(Bytes(56))); }
/// The 84 bytes that end every process of a domain: the same, with four bytes behind it.
inline Bytes statistics_and_more() { return joined({header(Bytes(12)), statistics(), Bytes(4)}); }

}  // namespace palpate::bus::testing
