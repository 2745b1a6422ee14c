#include "studies/volume_methods/volume_methods_command.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iomanip>
#include <limits>
#include <ostream>

#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/scene/scene_reader.h"
#include "studies/report/measures.h"
#include "studies/report/progress.h"
#include "studies/report/table_file.h"
#include "studies/volume_methods/measurements.h"

namespace palpate::volume_methods {
namespace {

constexpr double kQuickSeconds = 4;  // the probe is in the organ by then

struct MethodRow {
  Method method;
  VolumeErrors ball, organ;
  Cost cost;
  StepLimits limits;
  double drift = 0;
};

struct Column {
  const char* heading;
  const char* unit;
  const char* csv;
  int width;
  const char* format;
  double (*value)(const MethodRow&);
};

/// Infinite for a run that diverged, not a number where there is nothing to measure.
std::string text(const char* format, double value) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "diverged";
  return text_of(format, value);
}

double unless_diverged(const VolumeErrors& errors, double value) {
  return errors.diverged ? std::numeric_limits<double>::infinity() : value;
}

constexpr std::array<Column, 11> kColumns{{
    {"ball: error", "peak", "ball_volume_error_peak", 13, "%.1e",
     [](const MethodRow& r) { return unless_diverged(r.ball, r.ball.peak); }},
    {"", "held", "ball_volume_error_held", 9, "%.1e",
     [](const MethodRow& r) { return unless_diverged(r.ball, r.ball.held); }},
    {"plate", "[N]", "ball_plate_force_n", 7, "%.3f",
     [](const MethodRow& r) { return r.ball.force; }},
    {"pressure", "[Pa]", "ball_pressure_pa", 9, "%.1f",
     [](const MethodRow& r) { return r.ball.pressure + 0.0; }},
    {"organ: error", "peak", "organ_volume_error_peak", 13, "%.1e",
     [](const MethodRow& r) { return unless_diverged(r.organ, r.organ.peak); }},
    {"probe", "max [N]", "organ_probe_force_n", 8, "%.3f",
     [](const MethodRow& r) { return r.organ.force; }},
    {"step", "[us]", "step_cost_us", 7, "%.1f",
     [](const MethodRow& r) { return 1e6 * r.cost.step; }},
    {"cost", "/plain", "step_cost_over_plain", 7, "%.2f",
     [](const MethodRow& r) { return r.cost.relative; }},
    {"stable to", "[ms]", "largest_stable_step_ms", 10, "%.2f",
     [](const MethodRow& r) { return 1e3 * r.limits.measured; }},
    {"given", "[ms]", "largest_given_step_ms", 6, "%.2f",
     [](const MethodRow& r) { return 1e3 * r.limits.given; }},
    {"energy", "drift", "energy_drift", 9, "%.1e", [](const MethodRow& r) { return r.drift; }},
}};

std::size_t name_width() {
  std::size_t width = 0;
  for (const Method& method : compared_methods()) width = std::max(width, method.name.size());
  return width + 1;
}

void print_header(const VolumeMethodsOptions& options, std::ostream& out) {
  out << "Ball of " << (options.quick ? 162 : 642)
      << " nodes between plates, 30 % of its diameter in 1 s, held 1.5 s, opened in 0.5 s, h = 1 "
         "ms\n"
         "or the method's largest. Organ: the first of "
      << options.scene.filename().string()
      << ". Error: |V - V*|/V*. Stable to: found by bisection,\n"
      << 1e3 * kLongestTriedStep << " ms where no limit was found; given: the largest step the "
      << "method takes in a scene. Energy drift:\nundamped free vibration of the ball over "
      << kVibrationTime << " s at h = " << 1e3 * kVibrationStep << " ms.\n\n";
  const auto line = [&](const char* name, const char* Column::*words) {
    out << std::left << std::setw(static_cast<int>(name_width())) << name << std::right;
    for (const Column& column : kColumns) out << std::setw(column.width) << column.*words;
    out << '\n';
  };
  line("method", &Column::heading);
  line("", &Column::unit);
}

void print(const MethodRow& row, std::ostream& out) {
  out << std::left << std::setw(static_cast<int>(name_width())) << row.method.name << std::right;
  for (const Column& column : kColumns)
    out << std::setw(column.width) << text(column.format, column.value(row));
  out << std::endl;
}

void write_csv(const std::vector<MethodRow>& rows, const std::filesystem::path& file) {
  std::vector<std::string> names{"method"};
  for (const Column& column : kColumns) names.emplace_back(column.csv);
  report::TableFile table(file, names);
  for (const MethodRow& row : rows) {
    std::vector<std::string> cells{row.method.name};
    for (const Column& column : kColumns) cells.push_back(text("%.8g", column.value(row)));
    table.write_row(cells);
  }
  table.finish();
}

MethodRow measure(const Method& method, const VolumeMethodsOptions& options,
                  const scene::Scene& scene, report::Progress& progress) {
  progress.begin(method.name);
  MethodRow row;
  row.method = method;
  const double duration = options.quick ? kQuickSeconds : scene.duration;
  const std::vector<std::pair<const char*, std::function<void()>>> parts{
      {"squeezed ball", [&] { row.ball = squeeze_ball(method, options.quick); }},
      {"pressed organ", [&] { row.organ = press_organ(method, scene, duration); }},
      {"largest step", [&] { row.limits = step_limits(method, options.quick); }},
      {"free vibration", [&] { row.drift = energy_drift(method, options.quick); }},
      {"cost", [&] { row.cost = step_cost(method, options.quick); }}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    progress.at(static_cast<double>(i), static_cast<double>(parts.size()), parts[i].first);
    parts[i].second();
  }
  return row;
}

bool wanted(const VolumeMethodsOptions& options, const Method& method) {
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), method.name) != options.only.end();
}

}  // namespace

int run_volume_methods(const VolumeMethodsOptions& options, std::ostream& out, std::ostream& log) {
  const scene::Scene scene = scene::load_scene(options.scene);
  if (!options.out.empty()) report::make_out_folder(options.out);
  const StopSignal stop;
  report::Progress progress(log, [&] { return stop.requested(); });
  std::vector<MethodRow> rows;
  print_header(options, out);
  try {
    for (const Method& method : compared_methods()) {
      if (!wanted(options, method)) continue;
      rows.push_back(measure(method, options, scene, progress));
      print(rows.back(), out);
    }
  } catch (const report::Stopped&) {
    log << "stopped; nothing was written" << std::endl;
    return kExitStopped;
  }
  if (options.out.empty()) return kExitDone;
  write_csv(rows, options.out / "volume_methods.csv");
  out << "\nin " << (options.out / "volume_methods.csv").string() << '\n';
  return kExitDone;
}

}  // namespace palpate::volume_methods
