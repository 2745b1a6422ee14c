#include "modules/scene/value_text.h"

#include <array>
#include <charconv>
#include <cstdio>
#include <initializer_list>

namespace palpate::scene {
namespace {

std::string list_text(std::initializer_list<double> numbers) {
  std::string result;
  for (const double number : numbers) {
    result += result.empty() ? "[" : ", ";
    result += number_text(number);
  }
  return result += "]";
}

}  // namespace

std::string number_text(double value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

std::string list_text(const Vec3& value) { return list_text({value.x(), value.y(), value.z()}); }

std::string list_text(const Quat& value) {
  return list_text({value.x(), value.y(), value.z(), value.w()});
}

std::string quoted_text(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      std::array<char, 5> escape;
      std::snprintf(escape.data(), escape.size(), "\\x%02x", static_cast<unsigned char>(c));
      result += escape.data();
    } else {
      result += c;
    }
  }
  return result + "\"";
}

}  // namespace palpate::scene
