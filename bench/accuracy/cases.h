// What the models are judged by: loads applied to an organ, and what the truth answers to them.
//   ball      solid ball between frictionless plates      reference solutions (case A)
//   block     block with bonded ends, compressed          reference (case C), measured Truth Cube
//   indent    block under a frictionless 5 mm sphere      reference (case D)
//   vibration free ball, its ellipsoidal mode             Lamb's exact root (case E)
//   beam      a cantilever bends under its weight         the accurate rung, finer
//   liver, stomach   pressed by a sphere                  the accurate rung, finer
// All move slowly and come to rest at each load, but for vibration.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>

#include "bench/accuracy/rungs.h"

namespace palpate::accuracy {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// One load and the answers to it; kUnknown where there is none.
struct Sample {
  double load = 0;          ///< compression [1], depth [m]; the exact frequency [Hz] of vibration
  double force = kUnknown;  ///< on the probe [N]; the frequency [Hz] of vibration
  double reference_force = kUnknown;
  double shape = kUnknown;  ///< see Case::shape_name [m]
  double reference_shape = kUnknown;
  double field_error = kUnknown;  ///< RMS distance of points from where they should be [m]
};

struct Measurement {
  std::size_t surface_nodes = 0, inner_nodes = 0, tetrahedra = 0;
  double step = 0;          ///< h used [s]
  double cost = 0;          ///< processor seconds per simulated second
  double volume_error = 0;  ///< largest |V − V*|/V*
  bool diverged = false;
  std::vector<Sample> samples;
};

/// Asked at every period; may throw to end a run.
using KeepGoing = std::function<void()>;

struct Case {
  const char* name;
  const char* load_name;   ///< with unit, for axes
  const char* shape_name;  ///< what Sample::shape is; empty: nothing
  int level_count;         ///< meshes there are
  bool dynamic;            ///< needs velocities: kinematic models are left out
  bool truth_is_finest;    ///< the reference is quadratic_elements, measured first (sweep.h)
};

const std::vector<Case>& cases();
/// @throws InputError listing what there is
const Case& find_case(const std::string& name);

struct Source {
  std::filesystem::path references;           ///< folder of reference tables
  std::filesystem::path scenes;               ///< folder of scenes and their meshes
  std::optional<std::filesystem::path> data;  ///< third-party data, if there
};

/// @throws InputError if gmsh, a mesh or a reference is missing; what `keep_going` throws
Measurement measure(const Case& of, const Setting& setting, const Source& source,
                    const KeepGoing& keep_going);

/// √ mean of the squared relative errors of force; kUnknown if none is known.
double force_error(const Measurement& measurement);
/// √ mean of the squared differences of shape; kUnknown if none is known [m].
double shape_error(const Measurement& measurement);
/// √ mean of the squared field errors; kUnknown if none is known [m].
double field_error(const Measurement& measurement);

}  // namespace palpate::accuracy
