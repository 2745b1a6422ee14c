#include "studies/calibration/reference_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "modules/core/error.h"
#include "modules/core/input_file.h"

namespace palpate::calibration {
namespace {

std::vector<std::string> cells_of(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

/// One line of the table, with where it stands.
struct Line {
  const std::filesystem::path& file;
  const std::vector<std::string>& header;
  std::vector<std::string> cells;
  std::size_t number = 0;

  double value(const std::string& column) const {
    const auto index =
        static_cast<std::size_t>(std::find(header.begin(), header.end(), column) - header.begin());
    const std::string text = index < cells.size() ? cells[index] : "";
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value) ||
        value <= 0) {
      throw InputError(file.string() + ":" + std::to_string(number) + ": column '" + column +
                       "' = '" + text + "': must be a positive number");
    }
    return value;
  }
};

void demand_columns(const std::filesystem::path& file, const std::vector<std::string>& header,
                    const ReferenceColumns& columns) {
  for (const auto& column :
       {columns.compression, columns.force, columns.pressure, columns.equatorial_radius}) {
    if (column.empty() || std::find(header.begin(), header.end(), column) != header.end()) continue;
    throw InputError(file.string() + ":1: has no column '" + column + "'");
  }
}

}  // namespace

std::vector<ReferenceRow> read_reference(const std::filesystem::path& file,
                                         const ReferenceColumns& columns,
                                         double least_compression) {
  std::ifstream stream = open_input(file);
  std::string text;
  if (!std::getline(stream, text)) throw InputError(file.string() + ": is empty");
  const auto header = cells_of(text);
  demand_columns(file, header, columns);
  std::vector<ReferenceRow> rows;
  for (std::size_t number = 2; std::getline(stream, text); ++number) {
    const Line line{file, header, cells_of(text), number};
    ReferenceRow row;
    row.compression = line.value(columns.compression);
    row.force = line.value(columns.force);
    if (!columns.pressure.empty()) row.pressure = line.value(columns.pressure);
    row.equatorial_radius = 1e-3 * line.value(columns.equatorial_radius);
    if (row.compression >= least_compression) rows.push_back(row);
  }
  if (rows.empty()) throw InputError(file.string() + ": has no row of enough compression");
  return rows;
}

}  // namespace palpate::calibration
