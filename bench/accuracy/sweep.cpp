#include "bench/accuracy/sweep.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "bench/report/measures.h"
#include "bench/report/table_file.h"
#include "modules/scene/schema.h"

namespace palpate::accuracy {
namespace {

/// Of what is stored; raised when a case, a model or its constants change.
constexpr int kVersion = 2;

/// Neither the usual chart nor the quick one waits for these.
bool is_slow(const Setting& setting) { return setting.model == scene::Model::kQuadraticElements; }

bool wanted(const Case& of, const Setting& setting, Extent extent) {
  if (of.truth_is_finest && extent == Extent::kQuick) return false;
  // Under a small sphere its contacts take hundreds of factorizations per step.
  if (is_slow(setting) && std::string(of.name) == "indent" && extent != Extent::kFull) return false;
  const int finest = extent == Extent::kQuick ? 0 : extent == Extent::kUsual ? 1 : 2;
  if (setting.level > std::min(finest, of.level_count - 1)) return false;
  if (extent == Extent::kFull) return true;
  return !is_slow(setting) || setting.rate < 101;
}

std::vector<double> rates_of(Extent extent) {
  if (extent == Extent::kQuick) return {100};
  if (extent == Extent::kUsual) return {50, 250};
  return {50, 100, 250, 1000};
}

std::vector<double> numbers_of(const Measurement& m, const Sample& s) {
  return {double(m.surface_nodes),
          double(m.inner_nodes),
          double(m.tetrahedra),
          m.step,
          m.cost,
          m.volume_error,
          double(m.diverged),
          s.load,
          s.force,
          s.reference_force,
          s.shape,
          s.reference_shape,
          s.field_error};
}

const std::vector<std::string>& store_columns() {
  static const std::vector<std::string> kColumns{
      "surface_nodes", "inner_nodes",       "tetrahedra",   "step_s", "cost_s_per_s",
      "volume_error",  "diverged",          "load",         "force",  "reference_force",
      "shape_m",       "reference_shape_m", "field_error_m"};
  return kColumns;
}

void take(const std::vector<double>& n, Measurement& m) {
  m.surface_nodes = static_cast<std::size_t>(n[0]);
  m.inner_nodes = static_cast<std::size_t>(n[1]);
  m.tetrahedra = static_cast<std::size_t>(n[2]);
  m.step = n[3];
  m.cost = n[4];
  m.volume_error = n[5];
  m.diverged = n[6] != 0;
  m.samples.push_back({n[7], n[8], n[9], n[10], n[11], n[12]});
}

/// The truth's answers become the reference.
void refer(const Measurement& truth, Measurement& measurement) {
  for (std::size_t i = 0; i < std::min(truth.samples.size(), measurement.samples.size()); ++i) {
    measurement.samples[i].reference_force = truth.samples[i].force;
    measurement.samples[i].reference_shape = truth.samples[i].shape;
  }
}

}  // namespace

Setting truth_setting(const Case& of, Extent extent) {
  return {scene::Model::kQuadraticElements, extent == Extent::kFull ? of.level_count - 1 : 1, 50};
}

std::vector<Setting> settings_of(const Case& of, Extent extent) {
  std::vector<Setting> settings;
  if (of.truth_is_finest && extent != Extent::kQuick) settings.push_back(truth_setting(of, extent));
  for (const scene::Model model : ladder()) {
    for (int level = 0; level < of.level_count; ++level) {
      for (const double rate : rates_of(extent)) {
        const Setting setting{model, level, rate};
        if (!wanted(of, setting, extent)) continue;
        if (settings.empty() || settings[0].key() != setting.key()) settings.push_back(setting);
      }
    }
  }
  return settings;
}

PointStore::PointStore(std::filesystem::path folder) : folder_(std::move(folder)) {
  bench::make_out_folder(folder_);
}

std::filesystem::path PointStore::file_of(const Case& of, const Setting& setting) const {
  return folder_ / fmt::format("{}-{}-v{}.csv", of.name, setting.key(), kVersion);
}

bool PointStore::read(const Case& of, const Setting& setting, Measurement& out) const {
  std::ifstream stream(file_of(of, setting));
  std::string line;
  if (!std::getline(stream, line)) return false;
  out = {};
  while (std::getline(stream, line)) {
    std::vector<double> numbers;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      numbers.push_back(std::strtod(cell.c_str(), nullptr));
    }
    if (numbers.size() != store_columns().size()) return false;
    take(numbers, out);
  }
  return !out.samples.empty();
}

void PointStore::write(const Case& of, const Setting& setting,
                       const Measurement& measurement) const {
  bench::TableFile table(file_of(of, setting), store_columns());
  for (const Sample& sample : measurement.samples) {
    table.write_row(std::span<const double>(numbers_of(measurement, sample)));
  }
  table.finish();
}

std::vector<Point> sweep(const std::vector<Case>& of, Extent extent,
                         const std::vector<scene::Model>& models, const Source& source,
                         const PointStore& store,
                         const std::function<void(const std::string&, int, int)>& begin,
                         const KeepGoing& keep_going) {
  std::vector<Point> points;
  for (const Case& each : of) {
    for (const Setting& setting : settings_of(each, extent)) {
      const bool is_truth =
          each.truth_is_finest && setting.key() == truth_setting(each, extent).key();
      if (!is_truth && std::find(models.begin(), models.end(), setting.model) == models.end())
        continue;
      points.push_back({each, setting, {}});
    }
  }
  int done = 0;
  for (Point& point : points) {
    begin(fmt::format("{}: {}", point.of.name, point.setting.name()), done++,
          static_cast<int>(points.size()));
    if (store.read(point.of, point.setting, point.measurement)) continue;
    point.measurement = measure(point.of, point.setting, source, keep_going);
    store.write(point.of, point.setting, point.measurement);
  }
  for (Point& point : points) {
    if (!point.of.truth_is_finest) continue;
    Measurement truth;
    if (store.read(point.of, truth_setting(point.of, extent), truth)) {
      refer(truth, point.measurement);
    }
  }
  return points;
}

}  // namespace palpate::accuracy
