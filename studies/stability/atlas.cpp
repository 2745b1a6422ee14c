#include "studies/stability/atlas.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "modules/core/error.h"
#include "studies/report/measures.h"
#include "studies/report/table_file.h"

namespace palpate::stability {
namespace {

/// Of what is stored; raised when a map or a measure changes.
constexpr int kAtlasVersion = 1;

const std::vector<std::string>& store_columns() {
  static const std::vector<std::string> kColumns{
      "y",         "state", "energy", "volume_error", "inverted", "displacement",
      "predicted", "given", "exact"};
  return kColumns;
}

std::vector<double> numbers_of(const Cell& cell, const Prediction& prediction) {
  const Verdict& v = cell.verdict;
  return {cell.y,         double(v.state),  v.energy,         v.volume_error,          v.inverted,
          v.displacement, prediction.value, prediction.given, double(prediction.exact)};
}

void take(const std::vector<double>& n, Column& column) {
  Cell cell;
  cell.y = n[0];
  cell.verdict = {static_cast<State>(int(n[1])), n[2], n[3], n[4], n[5]};
  column.cells.push_back(cell);
  column.prediction = {n[6], n[7], n[8] != 0};
}

bool stands(const Cell& cell) { return holds(cell.verdict.state); }

/// Of the grid, so that a coarser run's columns are not taken for a finer one's.
std::size_t grid_key(const Map& map) {
  std::string text = fmt::format("{:.6g}", map.precision);
  for (const double y : map.ys) text += fmt::format(" {:.6g}", y);
  std::size_t key = 1469598103934665603u;  // FNV-1a: the same on every machine
  for (const char c : text) key = (key ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return key;
}

}  // namespace

Frontier frontier_of(const std::vector<Cell>& cells) {
  PALPATE_DEMAND(!cells.empty());
  const auto first = std::find_if(cells.begin(), cells.end(), stands);
  if (first == cells.end()) return {cells.front().y, Edge::kNoneHolds, 0};
  const double floor = first == cells.begin() ? 0 : (first - 1)->y;
  const auto above = std::find_if_not(first, cells.end(), stands);
  return {(above - 1)->y, above == cells.end() ? Edge::kAllHold : Edge::kFound, floor};
}

Column measure_column(const Map& map, const std::string& series, double x,
                      const KeepGoing& keep_going) {
  Column column{map.name, series, x, map.predict(series, x), {}};
  auto& cells = column.cells;
  for (const double y : map.ys) cells.push_back({y, map.attempt(series, x, y, keep_going)});
  while (frontier_of(cells).edge == Edge::kFound) {
    const auto first = std::find_if(cells.begin(), cells.end(), stands);
    const auto above = std::find_if_not(first, cells.end(), stands);
    const double low = (above - 1)->y, high = above->y;
    if (high <= low * (1 + map.precision)) break;
    const double middle = std::sqrt(low * high);
    cells.insert(above, {middle, map.attempt(series, x, middle, keep_going)});
  }
  return column;
}

ColumnStore::ColumnStore(const std::filesystem::path& folder, std::ostream& log)
    : files_(folder, log) {
  report::make_out_folder(folder);
}

std::string ColumnStore::name_of(const Map& map, const std::string& series, double x) {
  return fmt::format("{}-{}-{:g}-{:016x}-v{}", map.name, series, x, grid_key(map), kAtlasVersion);
}

bool ColumnStore::read(const Map& map, const std::string& series, double x, Column& out) const {
  const auto text = files_.read(name_of(map, series, x) + ".csv");
  std::istringstream stream(text.value_or(""));
  std::string line;
  if (!std::getline(stream, line)) return false;
  out = {map.name, series, x, {}, {}};
  while (std::getline(stream, line)) {
    std::vector<double> numbers;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      numbers.push_back(std::strtod(cell.c_str(), nullptr));
    }
    if (numbers.size() != store_columns().size()) return false;
    take(numbers, out);
  }
  return !out.cells.empty();
}

void ColumnStore::write(const Map& map, const Column& column) const {
  std::string text = report::table_line(store_columns());
  for (const Cell& cell : column.cells) {
    text += report::table_line(numbers_of(cell, column.prediction));
  }
  files_.write(name_of(map, column.series, column.x) + ".csv", text);
}

std::vector<double> geometric(double low, double high, int count) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    values.push_back(low * std::pow(high / low, double(i) / (count - 1)));
  }
  return values;
}

}  // namespace palpate::stability
