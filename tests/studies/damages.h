// What can become of a stored point, for tests of those who read it.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace palpate {

/// The file's text cut at every line and every few bytes, emptied, written twice, with a line
/// missing or twice, without its seal, with another digit, NaN for a number, other ends of lines.
inline std::vector<std::string> damaged(const std::string& whole) {
  std::vector<std::string> texts{whole + whole, whole.substr(0, whole.rfind("# sealed"))};
  for (std::size_t end = 0; end < whole.size(); ++end) {
    if (end % 7 == 0 || whole[end] == '\n') texts.push_back(whole.substr(0, end));
    if (end > 0 && whole[end - 1] == '\n') texts.push_back(whole.substr(0, end));
  }
  const std::size_t first = whole.find('\n') + 1, second = whole.find('\n', first) + 1;
  const std::string line = whole.substr(first, second - first);
  texts.push_back(std::string(whole).erase(first, line.size()));
  texts.push_back(std::string(whole).insert(first, line));
  const std::size_t digit = whole.find_first_of("0123456789", first);
  for (const char* other : {"9", "8", "nan", "abc"}) {
    if (whole.substr(digit, 1) != other)
      texts.push_back(std::string(whole).replace(digit, 1, other));
  }
  std::string ends = whole;
  for (std::size_t i = 0; (i = ends.find('\n', i)) != std::string::npos; i += 2)
    ends.insert(i, "\r");
  texts.push_back(ends);
  return texts;
}

}  // namespace palpate
