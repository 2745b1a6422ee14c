#include "bench/accuracy/accuracy_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "bench/accuracy/truth_cube.h"
#include "bench/report/measures.h"
#include "bench/report/plot_script.h"
#include "bench/report/progress.h"
#include "bench/report/table_file.h"
#include "modules/core/error.h"
#include "modules/runtime/stop_signal.h"
#include "modules/scene/schema.h"

namespace palpate::accuracy {
namespace {

std::vector<Case> wanted_cases(const AccuracyOptions& options, const Source& source,
                               std::ostream& log) {
  std::vector<Case> wanted;
  for (const auto& name : options.only_cases) wanted.push_back(find_case(name));
  if (wanted.empty()) wanted = cases();
  const auto without_data = [&](const Case& of) {
    if (std::string(of.name) != "truthcube" || source.data) return false;
    log << "truthcube: SKIPPED: PALPATE_DATA is not there\n";
    return true;
  };
  wanted.erase(std::remove_if(wanted.begin(), wanted.end(), without_data), wanted.end());
  return wanted;
}

std::vector<scene::Model> wanted_models(const AccuracyOptions& options) {
  if (options.only_models.empty()) return ladder();
  std::vector<scene::Model> wanted;
  for (const auto& name : options.only_models) {
    const auto all = ladder();
    const auto found = std::find_if(
        all.begin(), all.end(), [&](scene::Model model) { return name == scene::word_of(model); });
    if (found == all.end()) {
      std::vector<std::string> words;
      for (const auto model : all) words.emplace_back(scene::word_of(model));
      throw InputError(fmt::format("model '{}': must be one of {}", name, fmt::join(words, ", ")));
    }
    wanted.push_back(*found);
  }
  return wanted;
}

Source find_source(const AccuracyOptions& options) {
  Source source;
  source.references = options.root / "tests/data/reference";
  source.scenes = options.root / "scenes";
  const char* data = std::getenv("PALPATE_DATA");
  const std::filesystem::path folder = data != nullptr ? data : options.root / "../shared/data";
  if (std::filesystem::exists(folder / "truthcube")) source.data = folder;
  return source;
}

std::string number(double value, const char* format = "{:.3g}") {
  return std::isnan(value) ? "" : fmt::format(fmt::runtime(format), value);
}

void write_points(const std::vector<Point>& points, const std::filesystem::path& file) {
  bench::TableFile table(file, {"case", "model", "level", "rate_hz", "surface_nodes", "inner_nodes",
                                "tetrahedra", "step_s", "cost_s_per_s", "force_error",
                                "shape_error_m", "field_error_m", "volume_error", "diverged"});
  for (const Point& p : points) {
    const Measurement& m = p.measurement;
    table.write_row(std::vector<std::string>{
        p.of.name, scene::word_of(p.setting.model), std::to_string(p.setting.level),
        number(p.setting.rate, "{:g}"), std::to_string(m.surface_nodes),
        std::to_string(m.inner_nodes), std::to_string(m.tetrahedra), number(m.step, "{:.6g}"),
        number(m.cost, "{:.6g}"), number(force_error(m), "{:.6g}"),
        number(shape_error(m), "{:.6g}"), number(field_error(m), "{:.6g}"),
        number(m.volume_error, "{:.6g}"), m.diverged ? "1" : "0"});
  }
  table.finish();
}

void write_samples(const std::vector<Point>& points, const std::filesystem::path& file) {
  bench::TableFile table(
      file, {"case", "model", "level", "rate_hz", "load", "force", "reference_force", "shape_m",
             "reference_shape_m", "field_error_m"});
  for (const Point& p : points) {
    for (const Sample& s : p.measurement.samples) {
      table.write_row(std::vector<std::string>{
          p.of.name, scene::word_of(p.setting.model), std::to_string(p.setting.level),
          number(p.setting.rate, "{:g}"), number(s.load, "{:.6g}"), number(s.force, "{:.8g}"),
          number(s.reference_force, "{:.8g}"), number(s.shape, "{:.8g}"),
          number(s.reference_shape, "{:.8g}"), number(s.field_error, "{:.8g}")});
    }
  }
  table.finish();
}

void print(const std::vector<Point>& points, std::ostream& out) {
  out << fmt::format("{:<10} {:<19} {:>5} {:>6} {:>7} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9}\n",
                     "case", "model", "level", "[Hz]", "nodes", "h [ms]", "cost/s", "force",
                     "shape[mm]", "field[mm]", "volume");
  for (const Point& p : points) {
    const Measurement& m = p.measurement;
    const double force = force_error(m);
    out << fmt::format(
        "{:<10} {:<19} {:>5} {:>6g} {:>7} {:>8.3g} {:>9} {:>9} {:>9} {:>9} {:>9}{}\n", p.of.name,
        scene::word_of(p.setting.model), p.setting.level, p.setting.rate,
        m.surface_nodes + m.inner_nodes, 1e3 * m.step, number(m.cost),
        std::isnan(force) ? "" : fmt::format("{:.2f} %", 100 * force), number(1e3 * shape_error(m)),
        number(1e3 * field_error(m)), number(m.volume_error, "{:.1e}"),
        m.diverged ? "  diverged" : "");
  }
  out << "cost: processor seconds of one core per simulated second; force: root mean square over "
         "the loads of the relative error; shape and field: root mean square in mm.\n";
}

/// How well the beads of the Truth Cube themselves are known.
void print_noise(const std::vector<Case>& of, const Source& source, std::ostream& out) {
  for (const Case& each : of) {
    if (std::string(each.name) != "truthcube") continue;
    const TruthCube cube = read_truth_cube(*source.data / "truthcube");
    for (const auto& [compression, beads] : cube.states) {
      out << fmt::format("Truth Cube at {:g} %: tracking noise of the beads {:.2f} mm\n",
                         100 * compression, 1e3 * tracking_noise(cube, compression));
    }
  }
}

/// Bullet squeezes the ball in a program of its own, ours beside it.
void measure_peers(const AccuracyOptions& options, std::ostream& log) {
  if (!std::filesystem::exists(options.bullet_program)) {
    log << "Bullet: SKIPPED: palpate-bench-bullet was not built (libbullet-dev)\n";
    return;
  }
  const auto table = options.out / "bullet.csv";
  if (!options.again && std::filesystem::exists(table)) return;
  std::vector<std::string> words{options.bullet_program.string(), "--out", options.out.string()};
  if (options.extent != Extent::kFull) words.insert(words.end(), {"--nodes", "642"});
  if (options.extent == Extent::kQuick) words.emplace_back("--quick");
  if (bench::run_program(words) != 0) {
    throw std::runtime_error(options.bullet_program.string() + " failed");
  }
}

}  // namespace

int run_accuracy(const AccuracyOptions& options, std::ostream& out, std::ostream& log) {
  bench::make_out_folder(options.out);
  const Source source = find_source(options);
  const auto of = wanted_cases(options, source, log);
  const auto models = wanted_models(options);
  if (options.again) std::filesystem::remove_all(options.out / "points");
  const PointStore store(options.out / "points");
  const runtime::StopSignal stop;
  const KeepGoing keep_going = [&] {
    if (stop.requested()) throw bench::Stopped{};
  };
  try {
    const auto points = sweep(
        of, options.extent, models, source, store,
        [&](const std::string& what, int done, int total) {
          log << fmt::format("{} of {}: {}", done + 1, total, what) << std::endl;
        },
        keep_going);
    write_points(points, options.out / "points.csv");
    write_samples(points, options.out / "samples.csv");
    print(points, out);
    print_noise(of, source, out);
    if (options.peers) measure_peers(options, log);
    out << "on " << bench::machine_name() << '\n';
    bench::draw_figures(options.root / "scripts/plot_accuracy.py", options.out);
    out << "in " << options.out.string()
        << ": the charts, points.csv, samples.csv, bullet.csv; points/ is what a next run starts "
           "from\n";
    return kExitDone;
  } catch (const bench::Stopped&) {
    log << "stopped; finished points stay in " << (options.out / "points").string()
        << " and are not measured again" << std::endl;
    return bench::kExitStopped;
  }
}

}  // namespace palpate::accuracy
