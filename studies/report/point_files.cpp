#include "studies/report/point_files.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ostream>

#include "modules/core/crc32.h"
#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/core/whole_file.h"

namespace palpate::report {
namespace {

constexpr std::uintmax_t kLongest = 256u << 20;  // [bytes]
constexpr std::string_view kSealBegins = "# sealed: ";

/// "# sealed: 12 lines, CRC-32 1a2b3c4d", and the line's end.
std::string seal_of(std::string_view text) {
  const auto lines = static_cast<long>(std::count(text.begin(), text.end(), '\n'));
  const auto crc = crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  std::array<char, 64> words{};
  std::snprintf(words.data(), words.size(), "%ld lines, CRC-32 %08x\n", lines, crc);
  return std::string(kSealBegins) + words.data();
}

/// Where the last line begins.
std::size_t last_line_of(std::string_view text) {
  if (text.size() < 2) return 0;
  const std::size_t before = text.rfind('\n', text.size() - 2);
  return before == std::string_view::npos ? 0 : before + 1;
}

}  // namespace

std::optional<std::string> PointFiles::read(const std::string& name) const {
  const auto file = folder_ / name;
  if (!std::filesystem::exists(file)) return std::nullopt;
  std::string text = read_input(file, kLongest);
  const std::size_t end = last_line_of(text);
  const std::string_view whole(text), before = whole.substr(0, end), seal = whole.substr(end);
  if (seal == seal_of(before)) {
    text.resize(end);
    return text;
  }
  if (told_.insert(name).second) {
    *log_ << file.string()
          << (seal.starts_with(kSealBegins)
                  ? ": was changed since it was written (its seal does not match it)"
                  : ": was cut, or is of an older version (it does not end with its seal)")
          << "; it is not believed but measured again" << std::endl;
  }
  return std::nullopt;
}

void PointFiles::write(const std::string& name, std::string_view text) const {
  PALPATE_DEMAND(!text.empty() && text.back() == '\n');
  write_whole_file(folder_ / name, std::string(text) + seal_of(text));
}

}  // namespace palpate::report
