// Locking: how wrong the force of a coarse solid ball between plates becomes as Poisson's ratio
// goes to ½. Not a matter of steps: linear tetrahedra have no shapes left that keep their volume.
#pragma once

#include <filesystem>
#include <vector>

#include "modules/scene/scene.h"
#include "studies/report/claims.h"
#include "studies/report/point_files.h"
#include "studies/stability/runs.h"

namespace palpate::stability {

inline constexpr double kLockingCompression = 0.1;  ///< of the diameter
inline constexpr double kLockingModulus = 5e3;      ///< E [Pa]; forces are proportional to it

struct LockingPoint {
  std::string model = "corotational";
  double poisson_ratio = 0, computed_poisson_ratio = 0;  ///< asked for; deformation/models.h
  double force = 0, reference_force = 0;                 ///< on one plate [N]
  bool diverged = false;  ///< the guards had to put the organ back, or contacts were left out
  double error() const { return force / reference_force - 1; }
};

/// Force on a plate by quadratic elements with continuous pressure, which do not lock: an octant
/// with edges of 0.16 of the radius at its surface.
/// @param poisson_ratio  ≤ ½
/// @throws InputError if Gmsh is missing; std::runtime_error without equilibrium; what
///         `keep_going` throws
double locking_reference(double poisson_ratio, const KeepGoing& keep_going);

/// The same by a model as the simulator runs it, at rest, 162 nodes on the surface. The reference
/// is left open.
/// @throws InputError as above; what `keep_going` throws
LockingPoint locking_point(const std::string& model, double poisson_ratio,
                           const KeepGoing& keep_going);

/// Poisson's ratios of the map.
std::vector<double> locking_ratios(bool quick);

/// All linear tetrahedra at each of `ratios`, and what they are compared with.
/// @param files    one per point; must outlive them
/// @param results  filled as the points are read; must outlive them
std::vector<report::Point> locking_points(const std::vector<double>& ratios,
                                          const report::PointFiles& files,
                                          const KeepGoing& keep_going,
                                          std::vector<LockingPoint>& results);

void write_locking(const std::vector<LockingPoint>& points, const std::filesystem::path& file);

}  // namespace palpate::stability
