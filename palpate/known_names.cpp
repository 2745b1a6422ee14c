#include "palpate/known_names.h"

#include <algorithm>

namespace palpate::launcher {

std::string KnownNames::in(std::string text) const {
  for (const auto& [file, known] : names_) {
    for (auto at = text.find(file); at != std::string::npos; at = text.find(file, at)) {
      std::size_t end = at + file.size();
      const std::size_t digits = text.find_first_not_of("0123456789", end + 1);
      const bool line = end < text.size() && text[end] == ':' && digits != end + 1;
      if (line) end = std::min(digits, text.size());
      text.replace(at, end - at, known);
      at += known.size();
    }
  }
  return text;
}

std::streambuf::int_type NamingStream::Buffer::overflow(int_type letter) {
  if (letter == traits_type::eof()) return 0;
  line_ += static_cast<char>(letter);
  if (letter == '\n') pass_on();
  return letter;
}

int NamingStream::Buffer::sync() {
  pass_on();
  to_.flush();
  return 0;
}

void NamingStream::Buffer::pass_on() { to_ << names_.in(std::exchange(line_, {})); }

}  // namespace palpate::launcher
