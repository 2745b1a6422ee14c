#include "studies/calibration/calibration.h"

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"
#include "studies/report/progress.h"

namespace palpate::calibration {
namespace {

constexpr double kLeastCompression = 0.1;

/// One residual is weight · (scale · ratio − 1), or without the scale for a shape.
struct Residual {
  double weight = 0, ratio = 0;
  bool scales = false;
};

std::vector<Residual> residuals(const std::vector<Comparison>& comparisons,
                                const std::vector<ReferenceRow>& rows, double rest_radius) {
  std::vector<Residual> all;
  for (const Comparison& comparison : comparisons) {
    PALPATE_DEMAND(comparison.equilibria.size() == rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Ratios row = ratios(comparison.equilibria[i], rows[i], rest_radius);
      const double w = rows[i].compression;
      all.push_back({w, row.force, true});
      if (row.pressure) all.push_back({w, *row.pressure, true});
      all.push_back({w, row.radius, false});
    }
  }
  return all;
}

}  // namespace

Case hollow_ball(const std::filesystem::path& reference_folder) {
  Case hollow;
  hollow.name = "hollow";
  hollow.description = "fluid-filled ball, R 50 mm, wall 3 mm, E 50 kPa, against reference case B";
  hollow.ball.organ.tissue.youngs_modulus = 50e3;
  hollow.ball.organ.tissue.wall_thickness = 3e-3;
  hollow.ball.organ.springs.virtual_nodes = 1;  // a ball has no dominant axis, only a centre
  hollow.ball.surface_depth = hollow.ball.organ.tissue.wall_thickness / 2;
  hollow.rows = read_reference(
      reference_folder / "B_hollow_ball_plates.csv",
      {"compression_d_over_2R", "F_N", "cavity_pressure_Pa", "equatorial_outer_radius_mm"},
      kLeastCompression);
  hollow.largest_inner_ratio = 0.3;
  hollow.inner_ratio_tolerance = 0.005;
  hollow.fits_membrane = true;
  return hollow;
}

Case solid_ball(const std::filesystem::path& reference_folder) {
  Case solid;
  solid.name = "solid";
  solid.description = "solid ball, R 50 mm, E 5 kPa, incompressible, against reference case A";
  solid.ball.organ.tissue.youngs_modulus = 5e3;
  solid.ball.organ.tissue.wall_thickness = kSolidWallOverRadius * solid.ball.outer_radius;
  solid.ball.organ.springs.inner_ratio = kSolidInnerRatio;
  solid.ball.organ.springs.virtual_nodes = 1;
  solid.rows = read_reference(
      reference_folder / "A_ball_plates.csv",
      {"compression_d_over_2R", "F_N_incompressible", "", "equatorial_radius_mm_incompr"},
      kLeastCompression);
  solid.least_inner_ratio = 2;
  solid.largest_inner_ratio = 20;
  solid.inner_ratio_tolerance = 0.5;
  return solid;
}

Ratios ratios(const Equilibrium& model, const ReferenceRow& reference, double rest_radius) {
  Ratios ratios;
  ratios.force = model.force / reference.force;
  if (reference.pressure) ratios.pressure = model.pressure / *reference.pressure;
  ratios.radius = model.equatorial_radius / reference.equatorial_radius;
  ratios.bulge =
      (model.equatorial_radius - rest_radius) / (reference.equatorial_radius - rest_radius);
  return ratios;
}

Comparison compare(const Case& calibrated, int levels, const StopRequest& stop) {
  SqueezedBall ball(calibrated.ball, levels);
  Comparison comparison{node_count(levels), {}};
  for (const ReferenceRow& row : calibrated.rows) {
    if (stop && stop()) throw report::Stopped{};
    comparison.equilibria.push_back(ball.squeeze_to(row.compression));
  }
  return comparison;
}

Fit best_scale(const std::vector<Comparison>& comparisons, const std::vector<ReferenceRow>& rows,
               double rest_radius) {
  const auto all = residuals(comparisons, rows, rest_radius);
  double ratio_sum = 0, square_sum = 0;  // d/ds Σ w² (s a − 1)² = 0 → s = Σ w² a / Σ w² a²
  for (const Residual& r : all) {
    if (!r.scales) continue;
    ratio_sum += r.weight * r.weight * r.ratio;
    square_sum += r.weight * r.weight * r.ratio * r.ratio;
  }
  Fit fit;
  fit.stiffness_scale = ratio_sum / square_sum;
  double cost = 0, weights = 0;
  for (const Residual& r : all) {
    const double error = r.weight * ((r.scales ? fit.stiffness_scale : 1) * r.ratio - 1);
    cost += error * error;
    weights += r.weight * r.weight;
  }
  fit.cost = std::sqrt(cost / weights);
  return fit;
}

Fit fit(const Case& calibrated, double bending_ratio, const std::vector<int>& levels,
        const StopRequest& stop) {
  const auto fit_at = [&](double inner_ratio) {
    Case trial = calibrated;
    trial.ball.organ.springs.bending_ratio = bending_ratio;
    trial.ball.organ.springs.inner_ratio = inner_ratio;
    std::vector<Comparison> comparisons;
    comparisons.reserve(levels.size());
    for (const int level : levels) comparisons.push_back(compare(trial, level, stop));
    Fit best = best_scale(comparisons, trial.rows, trial.ball.outer_radius);
    best.bending_ratio = bending_ratio;
    best.inner_ratio = inner_ratio;
    return best;
  };
  return fit_at(golden_section([&](double inner_ratio) { return fit_at(inner_ratio).cost; },
                               calibrated.least_inner_ratio, calibrated.largest_inner_ratio,
                               calibrated.inner_ratio_tolerance));
}

double golden_section(const std::function<double(double)>& f, double low, double high,
                      double tolerance) {
  const double part = (std::sqrt(5.0) - 1) / 2;
  double left = high - part * (high - low), right = low + part * (high - low);
  double at_left = f(left), at_right = f(right);
  while (high - low > 2 * tolerance) {
    if (at_left <= at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - part * (high - low);
      at_left = f(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + part * (high - low);
      at_right = f(right);
    }
  }
  return (low + high) / 2;
}

}  // namespace palpate::calibration
