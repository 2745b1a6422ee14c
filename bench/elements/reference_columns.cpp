#include "bench/elements/reference_columns.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include "modules/core/error.h"

namespace palpate::elements_bench {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

std::vector<std::vector<double>> read_columns(const std::filesystem::path& file,
                                              const std::vector<std::string>& columns) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) throw InputError(file.string() + ": no such reference table");
  const auto header = cells_of(line);
  std::vector<std::size_t> places;
  for (const auto& column : columns) {
    const auto at = std::find(header.begin(), header.end(), column);
    if (at == header.end()) throw InputError(file.string() + ":1: no column " + column);
    places.push_back(static_cast<std::size_t>(at - header.begin()));
  }
  std::vector<std::vector<double>> rows;
  for (std::size_t number = 2; std::getline(stream, line); ++number) {
    const auto cells = cells_of(line);
    auto& row = rows.emplace_back();
    for (std::size_t c = 0; c < places.size(); ++c) {
      const std::string cell = places[c] < cells.size() ? cells[places[c]] : "";
      double value = 0;
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (error != std::errc() || end != cell.data() + cell.size()) {
        throw InputError(file.string() + ":" + std::to_string(number) + ": column " + columns[c] +
                         ": not a number");
      }
      row.push_back(value);
    }
  }
  return rows;
}

}  // namespace palpate::elements_bench
