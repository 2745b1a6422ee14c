#include "studies/report/table_file.h"

#include <array>
#include <cstdio>

namespace palpate::report {
namespace {

std::string quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\n") == std::string::npos) return cell;
  std::string text(1, '"');
  for (const char letter : cell) text.append(letter == '"' ? 2 : 1, letter);
  text.push_back('"');
  return text;
}

}  // namespace

TableFile::TableFile(std::filesystem::path file, const std::vector<std::string>& columns)
    : file_(std::move(file)) {
  write_row(columns);
}

void TableFile::write_row(std::span<const double> values) {
  std::array<char, 32> text{};
  const char* separator = "";
  for (const double value : values) {
    std::snprintf(text.data(), text.size(), "%s%.10g", separator, value);
    file_.stream() << text.data();
    separator = ",";
  }
  file_.stream() << '\n';
}

void TableFile::write_row(const std::vector<std::string>& cells) {
  const char* separator = "";
  for (const auto& cell : cells) {
    file_.stream() << separator << quoted(cell);
    separator = ",";
  }
  file_.stream() << '\n';
}

}  // namespace palpate::report
