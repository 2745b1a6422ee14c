#include "studies/calibration/report.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <ostream>

#include "deformation/model/spring_network.h"

namespace palpate::calibration {
namespace {

[[gnu::format(printf, 2, 3)]] void print(std::ostream& out, const char* format, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  out << text;
}

double percent(double ratio) { return 100 * (ratio - 1); }

void print_row(const Equilibrium& model, const ReferenceRow& reference, const Ratios& row,
               std::size_t nodes, std::ostream& out) {
  print(out, "%6zu %6.0f %%%c %8.4f %8.4f %+6.1f %%", nodes, 100 * model.compression,
        model.settled ? ' ' : '*', model.force, reference.force, percent(row.force));
  if (reference.pressure) {
    print(out, " %8.1f %8.1f %+6.1f %%", model.pressure, *reference.pressure,
          percent(*row.pressure));
  } else {
    print(out, " %8.1f %8s %8s", model.pressure, "-", "-");
  }
  print(out, " %7.2f %7.2f %+5.1f %% %+6.1f %%\n", 1e3 * model.equatorial_radius,
        1e3 * reference.equatorial_radius, percent(row.radius), percent(row.bulge));
}

}  // namespace

void print_settings(const Case& calibrated, std::ostream& out) {
  const auto& organ = calibrated.ball.organ;
  out << calibrated.name << ": " << calibrated.description << '\n';
  print(out, "  youngs_modulus_pa %g, wall_thickness_m %g, bending_ratio %g, inner_ratio %g\n",
        organ.tissue.youngs_modulus, organ.tissue.wall_thickness, organ.springs.bending_ratio,
        organ.springs.inner_ratio);
  print(out, "  membrane factor %g, nodes %g mm under the surface the plates touch\n",
        deformation::kMembraneFactor, 1e3 * calibrated.ball.surface_depth);
}

void print_comparisons(const Case& calibrated, const std::vector<Comparison>& comparisons,
                       std::ostream& out) {
  print(out, "%6s %9s %26s %26s %23s %8s\n", "", "", "force [N]", "pressure [Pa]", "equator [mm]",
        "bulge");
  print(out, "%6s %9s %8s %8s %8s %8s %8s %8s %7s %7s %7s %8s\n", "nodes", "squeezed", "model",
        "FEM", "error", "model", "FEM", "error", "model", "FEM", "error", "error");
  for (const Comparison& comparison : comparisons) {
    for (std::size_t i = 0; i < calibrated.rows.size(); ++i) {
      const Equilibrium& model = comparison.equilibria[i];
      print_row(model, calibrated.rows[i],
                ratios(model, calibrated.rows[i], calibrated.ball.outer_radius), comparison.nodes,
                out);
    }
    print(out, "       largest error at 30 to 50 %%: %.1f %%\n",
          100 * worst_error(calibrated, comparison));
  }
}

double worst_error(const Case& calibrated, const Comparison& comparison) {
  double worst = 0;
  for (std::size_t i = 0; i < calibrated.rows.size(); ++i) {
    if (calibrated.rows[i].compression < 0.3 - 1e-9) continue;
    const Ratios row =
        ratios(comparison.equilibria[i], calibrated.rows[i], calibrated.ball.outer_radius);
    for (const double ratio : {row.force, row.pressure.value_or(1), row.radius}) {
      worst = std::max(worst, std::abs(ratio - 1));
    }
  }
  return worst;
}

void print_fit_header(const Case& calibrated, std::ostream& out) {
  print(out, "fit     bending_ratio  inner_ratio  %15s  weighted rms\n",
        calibrated.fits_membrane ? "membrane factor" : "wall / radius");
}

void print_fit(const Case& calibrated, const Fit& fit, std::ostream& out) {
  const auto& ball = calibrated.ball;
  const double base = calibrated.fits_membrane
                          ? deformation::kMembraneFactor
                          : ball.organ.tissue.wall_thickness / ball.outer_radius;
  print(out, "        %13g  %11.3f  %15.3f  %10.1f %%\n", fit.bending_ratio, fit.inner_ratio,
        base * fit.stiffness_scale, 100 * fit.cost);
  out.flush();
}

void write_csv(const Case& calibrated, const std::vector<Comparison>& comparisons,
               std::ostream& out) {
  for (const Comparison& comparison : comparisons) {
    for (std::size_t i = 0; i < calibrated.rows.size(); ++i) {
      const Equilibrium& model = comparison.equilibria[i];
      const ReferenceRow& row = calibrated.rows[i];
      print(out, "%s,%zu,%g,%d,%.8g,%.8g,%.8g,", calibrated.name.c_str(), comparison.nodes,
            model.compression, model.settled ? 1 : 0, model.force, row.force, model.pressure);
      if (row.pressure) print(out, "%.8g", *row.pressure);
      print(out, ",%.8g,%.8g\n", model.equatorial_radius, row.equatorial_radius);
    }
  }
}

}  // namespace palpate::calibration
