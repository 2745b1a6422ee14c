#include "studies/chart/accuracy_tables.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "modules/scene/models.h"
#include "studies/chart/fidelity.h"
#include "studies/report/measures.h"
#include "studies/report/table_file.h"

namespace palpate::chart {
namespace {

std::string number(double value, const char* format = "{:.8g}") {
  return std::isnan(value) ? "" : fmt::format(fmt::runtime(format), value);
}

/// The columns that say which point it is.
const std::vector<std::string> kKeys{"case", "model", "level", "small", "rate_hz", "iterations"};

std::vector<std::string> columns(const std::vector<std::string>& further) {
  std::vector<std::string> all = kKeys;
  all.insert(all.end(), further.begin(), further.end());
  return all;
}

std::vector<std::string> row_of(const Point& p, const std::vector<double>& numbers) {
  std::vector<std::string> row{p.of.name,
                               p.setting.model,
                               std::to_string(p.setting.level),
                               word_of(p.setting.small),
                               number(p.setting.rate),
                               std::to_string(p.setting.iterations)};
  for (const double value : numbers) row.push_back(number(value));
  return row;
}

void write_points(const std::vector<Point>& points, const std::filesystem::path& file) {
  report::TableFile table(
      file, columns({"surface_nodes",        "inner_nodes",     "tetrahedra",      "step_s",
                     "cost_s_per_s",         "force_error",     "force_error_bar", "force_median",
                     "force_median_bar",     "force_95",        "force_95_bar",    "force_most",
                     "force_most_bar",       "ripple",          "shape_error_m",   "field_error_m",
                     "contact_radius_error", "profile_error_m", "volume_error",    "diverged",
                     "troubled_places"}));
  for (const Point& p : points) {
    const Measurement& m = p.measurement;
    const auto all = force_error_with_bar(m), half = force_quantile(m, 0.5),
               most = force_quantile(m, 0.95), worst = force_quantile(m, 1);
    table.write_row(row_of(p, {double(m.surface_nodes),
                               double(m.inner_nodes),
                               double(m.tetrahedra),
                               m.step,
                               m.cost,
                               all.value,
                               all.bar,
                               half.value,
                               half.bar,
                               most.value,
                               most.bar,
                               worst.value,
                               worst.bar,
                               ripple(m),
                               shape_error(m),
                               field_error(m),
                               contact_radius_error(m),
                               profile_error(m),
                               m.volume_error,
                               double(m.diverged),
                               double(m.troubled_places)}));
  }
  table.finish();
}

/// In the order of charts, with the iterations a step has where the scene asks for none.
void write_models(const std::filesystem::path& file) {
  report::TableFile table(file, {"model", "iterations"});
  for (const std::string& model : model_hierarchy()) {
    table.write_row(
        std::vector<std::string>{model, std::to_string(scene::format_of(model).iterations)});
  }
  table.finish();
}

void write_samples(const std::vector<Point>& points, const std::filesystem::path& file) {
  report::TableFile table(
      file, columns({"load", "place", "force", "reference_force", "reference_force_bar",
                     "estimated_error", "shape_m", "reference_shape_m", "field_error_m",
                     "contact_radius_m", "reference_contact_radius_m"}));
  for (const Point& p : points) {
    for (const Sample& s : p.measurement.samples) {
      table.write_row(row_of(p, {s.load, s.place, s.force, s.reference_force, s.reference_force_bar,
                                 s.estimated_error, s.shape, s.reference_shape, s.field_error,
                                 s.contact_radius, s.reference_contact_radius}));
    }
  }
  table.finish();
}

void write_profiles(const std::vector<Point>& points, const std::filesystem::path& file) {
  report::TableFile table(file, columns({"load", "distance_m", "displacement_m", "reference_m"}));
  for (const Point& p : points) {
    for (const Sample& s : p.measurement.samples) {
      for (std::size_t i = 0; i < kProfilePlaces.size(); ++i) {
        if (std::isnan(s.profile[i])) continue;
        table.write_row(
            row_of(p, {s.load, kProfilePlaces[i], s.profile[i], s.reference_profile[i]}));
      }
    }
  }
  table.finish();
}

void write_references(const std::vector<ReferenceSolution>& references,
                      const std::filesystem::path& file) {
  report::TableFile table(file, {"case", "level", "surface_nodes", "inner_nodes", "tetrahedra",
                                 "load", "place", "force", "force_bar", "shape_m"});
  for (const ReferenceSolution& reference : references) {
    for (std::size_t level = 0; level < reference.solved.size(); ++level) {
      const Measurement& m = reference.solved[level];
      for (const Sample& s : m.samples) {
        table.write_row(std::vector<std::string>{
            reference.of.name, std::to_string(level), std::to_string(m.surface_nodes),
            std::to_string(m.inner_nodes), std::to_string(m.tetrahedra), number(s.load),
            number(s.place), number(s.force), number(s.force_bar), number(s.shape)});
      }
    }
  }
  table.finish();
}

std::string short_number(double value) { return number(value, "{:.3g}"); }

std::string per_cent(double value) { return number(100 * value, "{:.2f} %"); }

/// "12.3 ± 0.4 %", or of what has no bar "12.3 %".
std::string per_cent(const Known& known) {
  if (!(known.bar > 0)) return per_cent(known.value);
  return std::isnan(known.value)
             ? ""
             : fmt::format("{:.2f} ± {:.2f} %", 100 * known.value, 100 * known.bar);
}

/// How many samples have an answer, and how well it is known.
void print_truth(const ReferenceSolution& reference, std::ostream& out) {
  std::vector<double> bars;
  std::size_t nodes = 0, count = 0;
  for (const Measurement& part : reference.solved) {
    nodes = std::max(nodes, part.surface_nodes);
    count += part.samples.size();
    for (const Sample& s : part.samples) {
      if (!std::isnan(s.force)) bars.push_back(s.force_bar / std::abs(s.force));
    }
  }
  out << fmt::format("truth of {}: {} of {} forces, up to {} nodes", reference.of.name, bars.size(),
                     count, nodes);
  if (!bars.empty()) {
    out << fmt::format("; ± {} in the median, {} at most", per_cent(report::median(bars)),
                       per_cent(std::ranges::max(bars)));
  }
  out << '\n';
}

/// The coarser mesh (or larger step) judged by the finer one.
void print_reference(const ReferenceSolution& reference, std::ostream& out) {
  Measurement coarse = reference.solved.front();
  const Measurement& fine = reference.solved.back();
  for (Sample& sample : coarse.samples) {
    sample.reference_force = sample.reference_shape = kUnknown;
  }
  refer(fine, coarse);
  out << fmt::format("reference of {}: {} nodes; the coarser of {} differs by", reference.of.name,
                     fine.surface_nodes + fine.inner_nodes,
                     coarse.surface_nodes + coarse.inner_nodes);
  const auto say = [&](const char* what, const std::string& value) {
    if (!value.empty()) out << ' ' << what << ' ' << value;
  };
  say("force", per_cent(force_error(coarse)));
  say("shape [mm]", short_number(1e3 * shape_error(coarse)));
  say("profile [mm]", short_number(1e3 * profile_error(coarse)));
  out << '\n';
}

}  // namespace

void write_tables(const SweepResult& result, const std::filesystem::path& folder) {
  write_models(folder / "models.csv");
  write_points(result.points, folder / "points.csv");
  write_samples(result.points, folder / "samples.csv");
  write_profiles(result.points, folder / "profiles.csv");
  write_references(result.references, folder / "reference_solutions.csv");
}

void print(const SweepResult& result, std::ostream& out) {
  out << fmt::format(
      "{:<11} {:<19} {:>5} {:<6} {:>6} {:>5} {:>7} {:>8} {:>9} {:>17} {:>9} {:>9} {:>9} {:>9} "
      "{:>9}\n",
      "case", "model", "level", "small", "[Hz]", "iter.", "nodes", "h [ms]", "cost/s", "force",
      "shape[mm]", "field[mm]", "contact", "profile", "volume");
  for (const Point& p : result.points) {
    const Measurement& m = p.measurement;
    out << fmt::format(
        "{:<11} {:<19} {:>5} {:<6} {:>6g} {:>5} {:>7} {:>8.3g} {:>9} {:>17} {:>9} {:>9} {:>9} "
        "{:>9} {:>9}{}\n",
        p.of.name, p.setting.model, p.setting.level, word_of(p.setting.small), p.setting.rate,
        p.setting.iterations > 0 ? std::to_string(p.setting.iterations) : "",
        m.surface_nodes + m.inner_nodes, 1e3 * m.step, short_number(m.cost),
        per_cent(force_error_with_bar(m)), short_number(1e3 * shape_error(m)),
        short_number(1e3 * field_error(m)), per_cent(contact_radius_error(m)),
        short_number(1e3 * profile_error(m)), number(m.volume_error, "{:.1e}"),
        m.diverged ? "  diverged" : "");
    if (!p.of.has_truth()) continue;
    out << fmt::format("    half of all forces within {}, 95 of 100 {}, all {}",
                       per_cent(force_quantile(m, 0.5)), per_cent(force_quantile(m, 0.95)),
                       per_cent(force_quantile(m, 1)));
    if (m.is_course) out << fmt::format("; ripple {}", per_cent(ripple(m)));
    if (m.troubled_places > 0) {
      out << fmt::format("; at {} places contacts were lost, or the organ put back",
                         m.troubled_places);
    }
    out << '\n';
  }
  out << "cost: processor seconds of one core per simulated second; force, contact (its radius): "
         "root mean square over the loads of the relative error; shape, field, profile: root mean "
         "square in mm; ±: what the reference's bar allows.\n";
  for (const ReferenceSolution& reference : result.references) {
    (reference.of.has_truth() ? print_truth : print_reference)(reference, out);
  }
}

}  // namespace palpate::chart
