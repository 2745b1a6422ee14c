#include "modules/core/text.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace palpate {

bool is_utf8(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const auto continues = [&](std::size_t from, std::size_t count) {
    for (std::size_t i = from; i < from + count; ++i) {
      if ((byte(i) & 0xc0u) != 0x80u) return false;
    }
    return true;
  };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned lead = byte(i), next = byte(i + 1);
    std::size_t more = 0;
    if (lead >= 0xc2 && lead <= 0xdf) more = 1;
    if ((lead & 0xf0u) == 0xe0) more = 2;
    if (lead >= 0xf0 && lead <= 0xf4) more = 3;
    if (lead >= 0x80 && more == 0) return false;
    const bool overlong = (lead == 0xe0 && next < 0xa0) || (lead == 0xf0 && next < 0x90);
    const bool beyond = (lead == 0xed && next > 0x9f) || (lead == 0xf4 && next > 0x8f);
    if (overlong || beyond || !continues(i + 1, more)) return false;
    i += 1 + more;
  }
  return true;
}

bool has_control_bytes(std::string_view text) {
  return std::ranges::any_of(text, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  });
}

std::string text_of(const char* format, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::string_view cut_at_letter(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return text;
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xc0u) == 0x80u) --bytes;
  return text.substr(0, bytes);
}

std::string after_colon(std::string_view line) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return {};
  const std::size_t begin = line.find_first_not_of(' ', colon + 1);
  return begin == std::string_view::npos ? std::string() : std::string(line.substr(begin));
}

std::string printable(std::string text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto before = static_cast<unsigned char>(i == 0 ? 0 : text[i - 1]);
    const bool high = before == 0xC2 && byte >= 0x80 && byte < 0xA0;  // U+0080 … U+009F in UTF-8
    if (byte < 0x20 || byte == 0x7F || high) text[i] = '?';
    if (high) text[i - 1] = '?';
  }
  return text;
}

}  // namespace palpate
