#include "studies/report/table_file.h"

#include <array>
#include <cstdio>
#include <stdexcept>

#include "studies/report/claims.h"

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
    : file_(std::move(file)), part_(file_), stream_((part_ += "." + process_word() + ".part")) {
  write_row(columns);
  if (!stream_) throw std::runtime_error("cannot write " + part_.string());
}

TableFile::~TableFile() {
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void TableFile::write_row(std::span<const double> values) {
  std::array<char, 32> text{};
  const char* separator = "";
  for (const double value : values) {
    std::snprintf(text.data(), text.size(), "%s%.10g", separator, value);
    stream_ << text.data();
    separator = ",";
  }
  stream_ << '\n';
}

void TableFile::write_row(const std::vector<std::string>& cells) {
  const char* separator = "";
  for (const auto& cell : cells) {
    stream_ << separator << quoted(cell);
    separator = ",";
  }
  stream_ << '\n';
}

void TableFile::finish() {
  stream_.close();
  if (!stream_) throw std::runtime_error("cannot write " + part_.string());
  std::filesystem::rename(part_, file_);
}

}  // namespace palpate::report
