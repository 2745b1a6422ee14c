#include "studies/report/reference_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "modules/core/error.h"
#include "modules/core/input_file.h"

namespace palpate::report {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

ReferenceTable::ReferenceTable(std::filesystem::path file) : file_(std::move(file)) {
  std::ifstream stream = open_input(file_);
  take(stream);
}

ReferenceTable::ReferenceTable(std::filesystem::path file, std::istream& lines)
    : file_(std::move(file)) {
  take(lines);
}

void ReferenceTable::take(std::istream& lines) {
  std::string line;
  if (!std::getline(lines, line)) throw InputError(file_.string() + ": is empty");
  names_ = cells_of(line);
  while (std::getline(lines, line)) rows_.push_back(cells_of(line));
}

double ReferenceTable::at(const std::string& column, std::size_t row) const {
  const auto name = std::find(names_.begin(), names_.end(), column);
  if (name == names_.end()) {
    throw InputError(file_.string() + ":1: column '" + column + "' is missing");
  }
  const auto place = static_cast<std::size_t>(name - names_.begin());
  const auto& cells = rows_.at(row);
  const std::string cell = place < cells.size() ? cells[place] : "";
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size()) {
    throw InputError(file_.string() + ":" + std::to_string(row + 2) + ": column " + column +
                     ": not a number");
  }
  return value;
}

std::size_t ReferenceTable::row_of(const std::string& column, double value) const {
  for (std::size_t row = 0; row < size(); ++row) {
    if (std::abs(at(column, row) - value) < 1e-9) return row;
  }
  std::ostringstream text;
  text << file_.string() << ": no row with " << column << " = " << value;
  throw InputError(text.str());
}

}  // namespace palpate::report
