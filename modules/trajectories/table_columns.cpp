#include "modules/trajectories/table_columns.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "modules/core/error.h"

namespace palpate::trajectories {
namespace {

constexpr std::array<const char*, 8> kOwnNames{"t", "x", "y", "z", "qx", "qy", "qz", "qw"};
constexpr std::size_t kScalar = 7;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && is_blank(s.front())) s.remove_prefix(1);
  while (!s.empty() && is_blank(s.back())) s.remove_suffix(1);
  if (s.size() >= 2 && s.front() == '"' && s.back() == '"') s = s.substr(1, s.size() - 2);
  return s;
}

bool is_number(const std::string& text) {
  double value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  return parsed.ec == std::errc{} && parsed.ptr == text.data() + text.size();
}

/// 3, of "4".
std::optional<std::size_t> column_number(const std::string& text) {
  std::size_t value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc{} || parsed.ptr != text.data() + text.size() || value == 0) return {};
  return value - 1;
}

std::string shown(const std::vector<std::string>& fields) {
  std::string text = fmt::format("{}", fmt::join(fields, ","));
  for (char& c : text) c = static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return text.size() > 80 ? text.substr(0, 80) + "…" : text;
}

/// The place of `name` among the header's; a number is a place. @throws InputError
std::size_t place_of(const std::string& name, const std::vector<std::string>& first) {
  if (const auto number = column_number(name)) {
    if (*number < first.size()) return *number;
    throw InputError(fmt::format("there is no column {}, only {}", name, first.size()));
  }
  const auto same = std::count(first.begin(), first.end(), name);
  if (same > 1) throw InputError(fmt::format("{} columns are named '{}'", same, name));
  if (same == 0) {
    throw InputError(fmt::format("no column is named '{}'; there are: {}", name, shown(first)));
  }
  return std::size_t(std::find(first.begin(), first.end(), name) - first.begin());
}

TableColumns by_own_names(const std::vector<std::string>& first, bool scalar_first) {
  TableColumns columns;
  for (std::size_t i = 0; i < kOwnNames.size(); ++i) {
    if (std::find(first.begin(), first.end(), kOwnNames[i]) == first.end()) {
      throw InputError(fmt::format(
          "header is '{}', must hold the columns {}; name others by key columns, as columns: "
          "[time, px, py, pz, q1, q2, q3, q4] or by number; of positions alone four are enough, as "
          "columns: [{}]",
          shown(first), fmt::join(kOwnNames, ","),
          first.size() == 4 ? fmt::format("{}", fmt::join(first, ", ")) : "time, px, py, pz"));
    }
    columns.of[i] = place_of(kOwnNames[i], first);
  }
  if (scalar_first && columns.of[kScalar] != columns.of[4] - 1) {
    throw InputError(fmt::format(
        "header is '{}', in which qw is not before qx; leave out key quaternion: names decide",
        shown(first)));
  }
  return columns;
}

/// @throws InputError for a column that is to be two things
void refuse_column_twice(const TableColumns& columns, const std::vector<std::string>& names,
                         const std::vector<std::size_t>& slots) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (columns.of[slots[i]] != columns.of[slots[k]]) continue;
      throw InputError(fmt::format(
          "key columns is [{}]: '{}' and '{}' are the same column, {}; each must be another",
          fmt::join(names, ", "), names[k], names[i], columns.of[slots[i]] + 1));
    }
  }
}

TableColumns by_names(const std::vector<std::string>& first, const std::vector<std::string>& names,
                      bool scalar_first) {
  TableColumns columns;
  columns.wanted = names.size();
  std::vector<std::size_t> slots;
  bool numbers = true;  // in the first line, where numbers are wanted
  for (std::size_t i = 0; i < names.size(); ++i) {
    // w x y z → x y z w
    const std::size_t slot = i < 4 || !scalar_first ? i : i == 4 ? kScalar : i - 1;
    slots.push_back(slot);
    columns.of[slot] = place_of(names[i], first);
    numbers = numbers && is_number(first[columns.of[slot]]);
  }
  refuse_column_twice(columns, names, slots);
  columns.headed = !numbers;
  return columns;
}

}  // namespace

char separator_of(std::string_view line) {
  for (const char separator : {'\t', ';', ','}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

bool next_field(std::string_view& rest, bool& more, char separator, std::string_view& field) {
  if (!more) return false;
  if (separator == ' ') {
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
    if (rest.empty()) return more = false;
  }
  const std::size_t end = rest.find(separator);
  field = trimmed(rest.substr(0, end));
  more = end != std::string_view::npos;
  rest.remove_prefix(more ? end + 1 : rest.size());
  return true;
}

std::vector<std::string> fields_of(std::string_view line, char separator) {
  std::vector<std::string> fields;
  std::string_view field;
  for (bool more = true; next_field(line, more, separator, field);) {
    if (fields.size() == kMostColumns) {
      throw InputError(fmt::format("has more than {} columns", kMostColumns));
    }
    fields.emplace_back(field);
  }
  return fields;
}

TableColumns find_columns(const std::vector<std::string>& first,
                          const std::vector<std::string>& names, bool scalar_first) {
  TableColumns columns =
      names.empty() ? by_own_names(first, scalar_first) : by_names(first, names, scalar_first);
  columns.count = first.size();
  return columns;
}

}  // namespace palpate::trajectories
