// Texts: whether those from elsewhere can be shown, what is shown of those that cannot, and
// numbers.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace palpate {

/// As Unicode defines it (table 3-7): no overlong forms, no surrogates, nothing beyond U+10FFFF.
bool is_utf8(std::string_view text);
/// What a terminal obeys: bytes below 0x20, and 0x7F.
bool has_control_bytes(std::string_view text);
/// A number, printf-style: text_of("%.2f s", 1.234).
std::string text_of(const char* format, double value);
/// Its first so many bytes; fewer where they would end within a letter of several (UTF-8).
std::string_view cut_at_letter(std::string_view text, std::size_t bytes);
/// What stands behind the first colon and the spaces after it: of "model name\t: Xeon" the last
/// word. Empty without one.
std::string after_colon(std::string_view line);
/// Control characters, U+0080 to U+009F among them, as '?'.
std::string printable(std::string text);

}  // namespace palpate
