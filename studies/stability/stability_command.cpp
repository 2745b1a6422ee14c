#include "studies/stability/stability_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/scene/schema.h"
#include "studies/report/claims.h"
#include "studies/report/measures.h"
#include "studies/report/plot_script.h"
#include "studies/report/progress.h"
#include "studies/report/table_file.h"
#include "studies/stability/locking.h"
#include "studies/stability/maps.h"

namespace palpate::stability {
namespace {

constexpr const char* kLocking = "locking";
constexpr double kGoal = 0.1;  // of measured against predicted, where theory is exact

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool wants(const StabilityOptions& options, const std::string& map) {
  return options.only_maps.empty() || contains(options.only_maps, map);
}

void refuse_unknown(const char* what, const std::vector<std::string>& asked,
                    const std::vector<std::string>& there) {
  for (const std::string& word : asked) {
    if (contains(there, word)) continue;
    throw InputError(fmt::format("{} '{}': must be one of {}", what, word, fmt::join(there, ", ")));
  }
}

/// Those asked for, with the series asked for.
std::vector<Map> wanted_maps(const StabilityOptions& options) {
  refuse_unknown("map", options.only_maps, map_names());
  std::vector<Map> wanted;
  std::vector<std::string> there;
  for (Map& map : maps(options.quick)) {
    if (!wants(options, map.name)) continue;
    for (const auto& name : map.series) {
      if (!contains(there, name)) there.push_back(name);
    }
    if (!options.only_series.empty()) {
      std::erase_if(map.series,
                    [&](const std::string& name) { return !contains(options.only_series, name); });
    }
    wanted.push_back(std::move(map));
  }
  refuse_unknown("series", options.only_series, there);
  return wanted;
}

/// A point for each column.
std::vector<report::Point> points_of(const std::vector<Map>& all, const ColumnStore& store,
                                     std::ostream& log, const KeepGoing& keep_going,
                                     std::vector<Column>& columns) {
  std::vector<report::Point> points;
  std::size_t count = 0;
  for (const Map& map : all) count += map.series.size() * map.xs.size();
  columns.resize(count);
  for (const Map& map : all) {
    for (const std::string& series : map.series) {
      for (const double x : map.xs) {
        Column& column = columns[points.size()];
        points.push_back(
            {store.key(map, series, x), [&, x] { return store.read(map, series, x, column); },
             [&, x] {
               log << fmt::format("{}: {}, x = {:.4g}", map.name, series, x) << std::endl;
               store.write(map, measure_column(map, series, x, keep_going));
             }});
      }
    }
  }
  return points;
}

const char* name_of(Edge edge) {
  switch (edge) {
    case Edge::kFound:
      return "found";
    case Edge::kAllHold:
      return "above";
    case Edge::kNoneHolds:
      break;
  }
  return "below";
}

std::string number(double value) { return std::isnan(value) ? "" : fmt::format("{:.6g}", value); }

/// Measured over predicted; NaN where either is not known.
double ratio_of(const Column& column) {
  const Frontier frontier = frontier_of(column.cells);
  return frontier.edge == Edge::kFound ? frontier.value / column.prediction.value
                                       : std::numeric_limits<double>::quiet_NaN();
}

void write_tries(const std::vector<Column>& columns, const std::filesystem::path& file) {
  report::TableFile table(file, {"map", "series", "x", "y", "state", "energy", "volume_error",
                                 "inverted", "displacement"});
  for (const Column& column : columns) {
    for (const Cell& cell : column.cells) {
      const Verdict& v = cell.verdict;
      table.write_row(std::vector<std::string>{
          column.map, column.series, number(column.x), number(cell.y), name_of(v.state),
          number(v.energy), number(v.volume_error), number(v.inverted), number(v.displacement)});
    }
  }
  table.finish();
}

void write_frontiers(const std::vector<Column>& columns, const std::filesystem::path& file) {
  report::TableFile table(file, {"map", "series", "x", "frontier", "edge", "fails_up_to",
                                 "predicted", "exact", "given", "measured_over_predicted"});
  for (const Column& column : columns) {
    const Frontier frontier = frontier_of(column.cells);
    const Prediction& p = column.prediction;
    table.write_row(std::vector<std::string>{
        column.map, column.series, number(column.x), number(frontier.value), name_of(frontier.edge),
        number(frontier.floor), number(p.value), p.exact ? "1" : "0", number(p.given),
        number(ratio_of(column))});
  }
  table.finish();
}

/// One line per map and series: the frontier from the first x to the last, and how far measured and
/// predicted are apart.
void print_series(const std::vector<Column>& columns, std::ostream& out) {
  std::string low, high;
  double least = 1e300, most = 0;
  for (const Column& column : columns) {
    const Frontier frontier = frontier_of(column.cells);
    const char* sign = frontier.edge == Edge::kFound     ? ""
                       : frontier.edge == Edge::kAllHold ? ">"
                                                         : "<";
    (low.empty() ? low : high) = fmt::format("{}{:.3g}", sign, frontier.value);
    const double ratio = ratio_of(column);
    if (std::isnan(ratio)) continue;
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  const std::string ratios = most > 0 ? fmt::format("{:.3f} .. {:.3f}", least, most) : "";
  out << fmt::format("{:<15} {:<25} {:>10} {:>10}  {}{}\n", columns.front().map,
                     columns.front().series, low, high, ratios,
                     columns.front().prediction.exact ? "" : " *");
}

void print(const std::vector<Column>& columns, std::ostream& out) {
  if (columns.empty()) return;
  out << fmt::format("{:<15} {:<25} {:>10} {:>10}  {}\n", "map", "series", "first x", "last x",
                     "measured / predicted frontier");
  int judged = 0, within = 0;
  for (std::size_t begin = 0; begin < columns.size();) {
    std::size_t end = begin;
    while (end < columns.size() && columns[end].map == columns[begin].map &&
           columns[end].series == columns[begin].series) {
      const double ratio = ratio_of(columns[end]);
      if (columns[end].prediction.exact && !std::isnan(ratio)) {
        ++judged;
        within += std::abs(ratio - 1) <= kGoal;
      }
      ++end;
    }
    print_series(
        {columns.begin() + static_cast<long>(begin), columns.begin() + static_cast<long>(end)},
        out);
    begin = end;
  }
  out << fmt::format(
      "frontier: largest step [s] (haptic_loop: stiffness [N/m]) that neither diverges nor "
      "oscillates; > all tried stand, < none does.\n* theory does not know all of it, or there is "
      "none. Where it is exact, {} of {} frontiers lie within {:g} % of it.\n",
      within, judged, 100 * kGoal);
}

/// Where a model is given steps that do not stand, and where small ones do not.
void print_surprises(const std::vector<Column>& columns, std::ostream& out) {
  for (const Column& column : columns) {
    const Frontier frontier = frontier_of(column.cells);
    const std::string where =
        fmt::format("{}, {}, x = {:.4g}", column.map, column.series, column.x);
    if (frontier.floor > 0) {
      out << fmt::format("{}: steps of {:.3g} s and some below do not stand\n", where,
                         frontier.floor);
    }
    if (frontier.edge == Edge::kAllHold || !(column.prediction.given > frontier.value)) continue;
    out << fmt::format("{}: is given {:.3g} s, stands up to {}{:.3g} s\n", where,
                       column.prediction.given,
                       frontier.edge == Edge::kNoneHolds ? "less than " : "", frontier.value);
  }
}

void print_locking(const std::vector<LockingPoint>& points, std::ostream& out) {
  out << "locking: error of the force at 10 % compression\n";
  for (const LockingPoint& p : points) {
    const bool capped = p.computed_poisson_ratio != p.poisson_ratio;
    out << fmt::format(
        "  nu {:<7g} {:<17} {:+8.1f} %{}{}\n", p.poisson_ratio, p.model, 100 * p.error(),
        p.diverged ? "  diverged" : "",
        capped ? fmt::format("  computed with {:.4g}", p.computed_poisson_ratio) : "");
  }
}

}  // namespace

std::vector<std::string> map_names() {
  std::vector<std::string> names;
  for (const Map& map : maps(true)) names.emplace_back(map.name);
  names.emplace_back(kLocking);
  return names;
}

int run_stability(const StabilityOptions& options, std::ostream& out, std::ostream& log) {
  const auto wanted = wanted_maps(options);
  report::make_out_folder(options.out);
  const auto folder = options.out / "points";
  if (options.again) std::filesystem::remove_all(folder);
  const ColumnStore store(folder, log);
  const report::PointFiles locking_files(folder, log);
  report::Claims claims(folder / "claims", options.shard);
  const StopSignal stop;
  const KeepGoing keep_going = [&] {
    if (stop.requested()) throw report::Stopped{};
    claims.keep();
  };
  try {
    std::vector<Column> columns;
    auto points = points_of(wanted, store, log, keep_going, columns);
    std::vector<LockingPoint> locking;
    if (wants(options, kLocking)) {
      const auto more =
          locking_points(locking_ratios(options.quick), locking_files, keep_going, locking);
      points.insert(points.end(), more.begin(), more.end());
    }
    const report::Share share = report::measure_points(points, claims);
    if (options.shard) {
      out << report::text_of(share, *options.shard);
      return kExitDone;
    }
    write_tries(columns, options.out / "atlas.csv");
    write_frontiers(columns, options.out / "frontiers.csv");
    print(columns, out);
    print_surprises(columns, out);
    if (wants(options, kLocking)) {
      write_locking(locking, options.out / "locking.csv");
      print_locking(locking, out);
    }
    report::draw_figures(data_file("plots/plot_stability.py"), options.out, {}, keep_going);
    out << "in " << options.out.string() << ": the charts, atlas.csv, frontiers.csv"
        << (wants(options, kLocking) ? ", locking.csv" : "")
        << "; points/ is what a next run starts from\n";
    return kExitDone;
  } catch (const report::Stopped&) {
    log << "stopped; finished points stay in " << folder.string() << " and are not measured again"
        << std::endl;
    return kExitStopped;
  }
}

}  // namespace palpate::stability
