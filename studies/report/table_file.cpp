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

std::string table_line(std::span<const double> values) {
  std::array<char, 32> text{};
  std::string line;
  for (const double value : values) {
    std::snprintf(text.data(), text.size(), "%s%.10g", line.empty() ? "" : ",", value);
    line += text.data();
  }
  return line + '\n';
}

std::string table_line(const std::vector<std::string>& cells) {
  std::string line;
  const char* separator = "";
  for (const auto& cell : cells) {
    line += separator + quoted(cell);
    separator = ",";
  }
  return line + '\n';
}

TableFile::TableFile(std::filesystem::path file, const std::vector<std::string>& columns)
    : file_(std::move(file)) {
  write_row(columns);
}

}  // namespace palpate::report
