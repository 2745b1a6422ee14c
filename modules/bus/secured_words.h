// The form of what DDS Security encrypts. Debian's Fast DDS 2.9.1 decrypts as many bytes as a
// packet says it has, whether they are there or not.
#pragma once

#include <cstdint>
#include <span>

namespace palpate::bus {

/// Follows the sub-messages of a packet. An encrypted one is three: in front transformation and
/// key, session and initialisation vector; the body; behind it authentication codes (DDS Security
/// 1.1, sections 7.3.6 and 9.5.3.3).
class SecuredWords {
 public:
  static bool is_one(std::uint8_t kind) { return kind >= kBody && kind <= kPostfix; }

  /// Whether a sub-message may stand behind those before, and its content has the lengths that it
  /// says: all of one order of bytes, the body encrypted.
  /// @param whole  with its header
  bool follows(std::span<const std::uint8_t> whole);

  /// Nothing is missing behind the last one.
  bool complete() const { return due_ == 0; }

 private:
  static constexpr std::uint8_t kBody = 0x30, kPrefix = 0x31, kPostfix = 0x32;

  std::uint8_t due_ = 0;  ///< kind that must come; 0: any
};

}  // namespace palpate::bus
