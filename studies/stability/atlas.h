// Maps of where methods stand and fall: one parameter across, the step (or what the step is to a
// hand: stiffness) upwards, and the frontier between.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "studies/report/point_files.h"
#include "studies/stability/runs.h"

namespace palpate::stability {

struct Map {
  const char* name;
  std::vector<std::string> series;  ///< models, or ways to close a loop
  std::vector<double> xs, ys;       ///< rising; ys > 0
  double precision;                 ///< of the frontier: bisected until the ratio is below 1 + this
  std::function<Verdict(const std::string& series, double x, double y, const KeepGoing&)> attempt;
  std::function<Prediction(const std::string& series, double x)> predict;
};

/// One try.
struct Cell {
  double y = 0;
  Verdict verdict;
};

/// All tries at one x, by rising y: the map's and those of the bisection.
struct Column {
  std::string map, series;
  double x = 0;
  Prediction prediction;
  std::vector<Cell> cells;
};

enum class Edge {
  kFound,     ///< bisected
  kAllHold,   ///< every y stands: the frontier is higher
  kNoneHolds  ///< not even the lowest: it is lower
};

struct Frontier {
  double value = 0;  ///< the largest y that stands below the next that does not; or the edge
  Edge edge = Edge::kFound;
  double floor = 0;  ///< the largest y below all that stand that does not itself; 0: none
};

/// Of the lowest y that stand. Above the failure that ends them some y may stand again; that is not
/// trusted.
/// @param cells  by rising y, not empty
Frontier frontier_of(const std::vector<Cell>& cells);

/// @throws what a try throws
Column measure_column(const Map& map, const std::string& series, double x,
                      const KeepGoing& keep_going);

/// Columns of earlier runs, one file each, which appears whole or not at all.
class ColumnStore {
 public:
  /// @param folder  made if need be
  /// @param log     told of columns that are not whole
  ColumnStore(const std::filesystem::path& folder, std::ostream& log);

  /// @returns false if it has not been measured with these ys and this precision, or by another
  ///          version of this program, or is not whole
  bool read(const Map& map, const std::string& series, double x, Column& out) const;
  void write(const Map& map, const Column& column) const;
  /// A word for the column, in all runs that would measure the same.
  std::string key(const Map& map, const std::string& series, double x) const {
    return name_of(map, series, x);
  }

 private:
  static std::string name_of(const Map& map, const std::string& series, double x);

  report::PointFiles files_;
};

/// `count` values from `low` to `high` in equal ratios.
std::vector<double> geometric(double low, double high, int count);

}  // namespace palpate::stability
