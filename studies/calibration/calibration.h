// Spring stiffness fitted to finite-element solutions of squeezed balls.
//
// Parameters of a fit: inner_ratio, and the scale of E t. Every spring is proportional to E t, so
// at rest force and pressure are too and the shape does not change: the best scale for a given
// inner_ratio follows in closed form (variable projection, Golub & Pereyra 1973), and golden
// section over inner_ratio is left. The bending ratio is hardly determined by these data; the fit
// is repeated for a few.
//
// Residuals: force, pressure and equatorial radius, each model / reference − 1, times the
// compression: half as much squeezed, half as much counted. What springs can follow, 30 to 50 %, so
// decides; below it a thick wall's bending carries most of the force, and surface springs have next
// to none (docs/calibration.md).
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "studies/calibration/reference_table.h"
#include "studies/calibration/squeezed_ball.h"

namespace palpate::calibration {

/// Recommended for a solid organ, whose wall is a means only: E t/R stands for the stiffness of a
/// layer under the surface, the inner springs for the rest.
inline constexpr double kSolidWallOverRadius = 0.16;
inline constexpr double kSolidInnerRatio = 10;

/// What a ball is squeezed to learn.
struct Case {
  std::string name;
  std::string description;
  BallSetup ball;  ///< with the settings shipped or recommended
  std::vector<ReferenceRow> rows;
  double least_inner_ratio = 0, largest_inner_ratio = 0, inner_ratio_tolerance = 0;  ///< of the fit
  bool fits_membrane = false;  ///< what the scale of E t stands for: the membrane factor, or the
                               ///< thickness of a wall a solid does not have
};

/// Case B: fluid-filled hollow ball, wall 3 mm, E 50 kPa. @throws InputError as read_reference()
Case hollow_ball(const std::filesystem::path& reference_folder);
/// Case A: solid ball, E 5 kPa.
Case solid_ball(const std::filesystem::path& reference_folder);

/// A model's answer to all rows of a case, beside the reference.
struct Comparison {
  std::size_t nodes = 0;
  std::vector<Equilibrium> equilibria;  ///< one per row of the case
};

/// Ratios model / reference of one row; without the reference's pressure its ratio is absent.
struct Ratios {
  double force = 0;
  std::optional<double> pressure;
  double radius = 0;  ///< of the equatorial radius
  double bulge = 0;   ///< of its growth over R: the stricter measure
};

/// @param rest_radius  R [m]
Ratios ratios(const Equilibrium& model, const ReferenceRow& reference, double rest_radius);

using StopRequest = std::function<bool()>;

/// Squeezes the case's ball to all its compressions, in rising order.
Comparison compare(const Case& calibrated, int levels, const StopRequest& stop);

struct Fit {
  double bending_ratio = 0, inner_ratio = 0;
  double stiffness_scale = 1;  ///< of E t over the case's own
  double cost = 0;             ///< weighted root mean square of the relative errors
};

/// The scale of least cost, and that cost; the ratios are left as they are.
/// @param rows  those of every comparison
Fit best_scale(const std::vector<Comparison>& comparisons, const std::vector<ReferenceRow>& rows,
               double rest_radius);

/// Fits on all meshes together, so that the answer holds for any of them.
Fit fit(const Case& calibrated, double bending_ratio, const std::vector<int>& levels,
        const StopRequest& stop);

/// Smallest value of f on [low, high] by golden section, to ± tolerance in x. One minimum assumed.
double golden_section(const std::function<double(double)>& f, double low, double high,
                      double tolerance);

}  // namespace palpate::calibration
