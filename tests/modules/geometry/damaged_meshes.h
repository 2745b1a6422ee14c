// Files with random bytes taken out, changed and put in, and what a reader says of them.
#pragma once

#include <algorithm>
#include <random>
#include <string>

#include "modules/core/error.h"

namespace palpate::geometry::test {

/// What `parse(bytes, name)` refuses them with.
template <class Parse>
std::string refusal_by(const Parse& parse, const std::string& bytes, const char* name) {
  try {
    parse(bytes, name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// Half of the changes lie in the first 250 bytes: in a header.
class DamagedFiles {
 public:
  explicit DamagedFiles(std::string whole) : whole_(std::move(whole)) {}

  std::string next() {
    std::string bytes = whole_;
    for (std::size_t change = 0; change <= below(6); ++change) {
      const std::size_t at =
          below(change % 2 == 0 ? bytes.size() : std::min<std::size_t>(250, bytes.size()));
      const std::size_t length = below(9);
      if (count_ % 3 == 0) bytes.erase(at, length);
      if (count_ % 3 == 1) bytes[at] = char(random_());
      if (count_ % 3 == 2) bytes.insert(at, length, char(random_()));
    }
    ++count_;
    return bytes;
  }

 private:
  std::size_t below(std::size_t end) { return std::size_t(random_() % end); }

  std::string whole_;
  std::mt19937 random_{7};
  int count_ = 0;
};

}  // namespace palpate::geometry::test
