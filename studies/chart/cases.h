// What the models are judged by: loads applied to an organ, and the answers known to them.
//   ball      solid ball between frictionless plates      reference solutions (case A)
//   block     block with bonded ends, compressed          reference (case C), measured Truth Cube
//   indent    block under a frictionless 5 mm sphere      reference (case D)
//   vibration free ball, its ellipsoidal mode             Lamb's exact root (case E)
//   squeeze   the ball, squeezed within 50 ms             the most accurate model in small steps
//   beam      a cantilever bends under its weight         equilibrium of the most accurate model
//   liver, stomach   pressed by a sphere of 8 mm at random places    the same, on two meshes
//   liver_4mm, stomach_4mm   the same with 4 mm
//   slide     a block under a sphere that slides at constant depth   the same
// All but vibration and squeeze move slowly and come to rest at each load.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>

#include "studies/chart/fidelity.h"
#include "studies/report/progress.h"

namespace palpate::chart {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Where the surface's profile is looked at: this far from the axis of the indenter [m].
inline constexpr std::array kProfilePlaces{6e-3, 8e-3, 10e-3, 12e-3, 15e-3, 20e-3, 25e-3, 30e-3};
/// Along the indenter's axis, outward [m].
using Profile = std::array<double, kProfilePlaces.size()>;

inline constexpr Profile unknown_profile() {
  Profile profile{};
  profile.fill(kUnknown);
  return profile;
}

/// One load and the answers to it; kUnknown where there is none.
struct Sample {
  double load = 0;  ///< compression [1], depth [m], time [s]; exact frequency [Hz] of vibration
  double force = kUnknown;  ///< on the probe [N]; the frequency [Hz] of vibration
  double reference_force = kUnknown;
  /// Growth of the ball's equator, bulge of the block's face, sag of the beam's tip [m].
  double shape = kUnknown;
  double reference_shape = kUnknown;
  double field_error = kUnknown;     ///< RMS distance of points from where they should be [m]
  double contact_radius = kUnknown;  ///< of the touching nodes' share of the surface [m]
  double reference_contact_radius = kUnknown;
  Profile profile = unknown_profile();
  Profile reference_profile = unknown_profile();
  double place = 0;             ///< number, of an organ pressed at many
  double force_bar = kUnknown;  ///< of a reference: it is that far off at most [N]
  double reference_force_bar = kUnknown;
  double estimated_error = kUnknown;  ///< of the force, as a model says itself [1]
};

struct Measurement {
  std::size_t surface_nodes = 0, inner_nodes = 0, tetrahedra = 0;
  double step = 0;          ///< h used [s]
  double cost = 0;          ///< processor seconds per simulated second
  double volume_error = 0;  ///< largest |V − V*|/V*
  bool diverged = false;    ///< or contacts were left out: no result
  bool is_course = false;   ///< samples are times of one motion, where forces may pass through 0
  std::size_t troubled_places = 0;  ///< of many: where contacts were lost, or the organ put back
  std::vector<Sample> samples;
};

using report::KeepGoing;

/// Who knows the answers.
enum class Reference {
  kTable,   ///< a table knows all of them
  kPartly,  ///< a table knows all but the profile, which reference_solutions.h has
  kOwn      ///< reference_solutions.h alone
};

struct Case {
  const char* name;
  int level_count;  ///< meshes there are
  Reference reference;
  /// Of a truth that has a bar: its parts, all of them it. None: a reference on kReferenceLevels
  /// meshes.
  int truth_count = 0;

  bool has_truth() const { return truth_count > 0; }
};

const std::vector<Case>& cases();
/// @throws InputError listing what there is
const Case& find_case(const std::string& name);

/// @throws InputError if gmsh, a mesh or a reference is missing; what `keep_going` throws
Measurement measure(const Case& of, const Setting& setting, const KeepGoing& keep_going);

/// How many solve_reference() knows; 0: a table knows all.
int reference_count(const Case& of);
/// What no table knows: a part of the truth, or all on a finer mesh the higher the number.
/// @param of  not Reference::kTable alone @throws as measure()
Measurement solve_reference(const Case& of, int number, const KeepGoing& keep_going);
/// All of them as one: parts together, or the finest mesh, whose force may be as far off as the
/// mesh before it differs.
Measurement whole_reference(const Case& of, const std::vector<Measurement>& solved);
/// Its answers become references where there is none.
void refer(const Measurement& reference, Measurement& measurement);

/// What is known to ± a bar.
struct Known {
  double value = kUnknown, bar = 0;
};
/// √ mean of the squared relative errors of force, of a course over time over the course's own √
/// mean square; kUnknown if none is known. The bar is what the references' bars allow.
Known force_error_with_bar(const Measurement& measurement);
inline double force_error(const Measurement& m) { return force_error_with_bar(m).value; }
/// The relative error of force that so many of 1 do not exceed.
Known force_quantile(const Measurement& measurement, double part);
/// (Largest − least) of force over reference, over their mean: of a course, what the hand feels.
double ripple(const Measurement& measurement);
/// √ mean of the squared differences of shape; kUnknown if none is known [m].
double shape_error(const Measurement& measurement);
/// √ mean of the squared field errors; kUnknown if none is known [m].
double field_error(const Measurement& measurement);
/// √ mean of the squared relative errors of the contact's radius; kUnknown if none is known.
double contact_radius_error(const Measurement& measurement);
/// √ mean of the squared differences of the profile; kUnknown if none is known [m].
double profile_error(const Measurement& measurement);

}  // namespace palpate::chart
