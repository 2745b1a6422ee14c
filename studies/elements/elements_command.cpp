#include "studies/elements/elements_command.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <ostream>
#include <stdexcept>

#include "modules/core/error.h"
#include "modules/core/whole_file.h"
#include "studies/report/measures.h"

namespace palpate::elements_bench {
namespace {

template <typename... Numbers>
void print(std::ostream& out, const char* format, Numbers... numbers) {
  char buffer[240];
  std::snprintf(buffer, sizeof buffer, format, numbers...);
  out << buffer;
}

double error_of(double value, double reference) { return value / reference - 1; }

void print_run(const Run& run, double seconds, std::ostream& out) {
  print(out, "\nsize %g: %zu nodes, %zu elements, %zu unknowns, %.0f s%s\n", run.size, run.nodes,
        run.elements, run.unknowns, seconds,
        run.complete ? "" : "; NOT COMPLETE: Newton failed beyond the last row");
  print(out, "%12s %12s %12s %9s %12s %9s %6s\n", "load", "value", "reference", "error %",
        "bulge [mm]", "error %", "Newton");
  for (const ErrorRow& row : run.rows) {
    print(out, "%12.5g %12.6g %12.6g %9.3f", row.load, row.force, row.reference_force,
          100 * error_of(row.force, row.reference_force));
    if (row.reference_bulge > 0) {
      print(out, " %12.5g %9.3f", 1e3 * row.bulge, 100 * error_of(row.bulge, row.reference_bulge));
    } else {
      print(out, " %12s %9s", "", "");
    }
    print(out, " %6d\n", row.iterations);
  }
  out.flush();
}

/// Errors of all meshes side by side, and the order between the first and the last.
void print_convergence(const std::vector<Run>& runs, std::ostream& out) {
  if (runs.size() < 2) return;
  std::size_t rows = runs[0].rows.size();
  for (const Run& run : runs) rows = std::min(rows, run.rows.size());
  print(out, "\nerror of force or frequency [%%] against size\n%12s", "load");
  for (const Run& run : runs) print(out, " %9g", run.size);
  print(out, " %9s\n", "order");
  for (std::size_t r = 0; r < rows; ++r) {
    print(out, "%12.5g", runs[0].rows[r].load);
    std::vector<double> errors;
    for (const Run& run : runs) {
      errors.push_back(error_of(run.rows[r].force, run.rows[r].reference_force));
      print(out, " %9.3f", 100 * errors.back());
    }
    print(out, " %9.1f\n",
          observed_order(errors.front(), errors.back(), runs.front().size, runs.back().size));
  }
  out.flush();
}

void write_csv(const std::filesystem::path& file, const std::vector<Run>& runs) {
  WholeFile whole(file);
  std::ostream& csv = whole.stream();
  csv << "size_ratio,nodes,elements,unknowns,load,value,reference,bulge_m,reference_bulge_m,"
         "newton_iterations\n";
  csv.precision(10);
  for (const Run& run : runs) {
    for (const ErrorRow& row : run.rows) {
      csv << run.size << ',' << run.nodes << ',' << run.elements << ',' << run.unknowns << ','
          << row.load << ',' << row.force << ',' << row.reference_force << ',' << row.bulge << ','
          << row.reference_bulge << ',' << row.iterations << '\n';
    }
  }
  whole.finish();
}

const char* heading(const std::string& name) {
  if (name == "A") return "A  ball between plates: load = compression / 2R, value = force [N]";
  if (name == "C") return "C  bonded block: load = compression, value = force [N]";
  if (name == "D") return "D  indented block: load = depth [m], value = force [N]";
  return "E  free vibration of a ball: load and reference = Lamb's roots [Hz], value [Hz]";
}

}  // namespace

double observed_order(double coarse_error, double fine_error, double coarse_size,
                      double fine_size) {
  return std::log(std::abs(coarse_error / fine_error)) / std::log(coarse_size / fine_size);
}

int run_elements(const ElementsOptions& options, const std::function<void()>& keep_going,
                 std::ostream& out, std::ostream& log) {
  if (!options.out.empty()) report::make_out_folder(options.out);
  for (const auto& name : options.cases.empty() ? case_names() : options.cases) {
    out << '\n' << heading(name) << '\n';
    std::vector<Run> runs;
    std::string stopped;  // why
    for (const double size :
         options.sizes.empty() ? default_sizes(name, options.quick) : options.sizes) {
      const auto start = std::chrono::steady_clock::now();
      const Setting setting{options.reference_folder, options.quick, keep_going,
                            [&](const std::string& line) {
                              log << name << " size " << size << ": " << line << std::endl;
                            }};
      try {
        runs.push_back(run_case(name, size, setting));
      } catch (const Interrupted& stop) {
        stopped = stop.what();
        break;
      }
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      print_run(runs.back(), elapsed.count(), out);
    }
    print_convergence(runs, out);
    if (!options.out.empty()) write_csv(options.out / ("elements_" + name + ".csv"), runs);
    if (stopped.empty()) continue;
    log << stopped << std::endl;
    return kExitStopped;
  }
  return kExitDone;
}

}  // namespace palpate::elements_bench
