// What the methods of deformation/volume/rules are compared by: the same ball, springs and plates
// for all, and the same stomach under the same probe.
#pragma once

#include <string>
#include <vector>

#include "modules/scene/scene.h"

namespace palpate::volume_methods {

/// One row of the table.
struct Method {
  std::string name;
  std::string model = "implicit_volume";
  std::size_t corrections = 0;
};

/// From no constraint to the implicit one with a Newton correction.
std::vector<Method> compared_methods();

/// |V − V*|/V* and what the plates or the probe feel.
struct VolumeErrors {
  double step = 0;        ///< used: 1 ms or the method's largest [s]
  double peak = 0;        ///< largest at any time
  double held = 0;        ///< largest in the last half second of holding
  double force = 0;       ///< of one plate held; largest of the probe [N]
  double pressure = 0;    ///< of the contents held; unused for the probe [Pa]
  bool diverged = false;  ///< came to a state that is not finite or faster than 100 m/s
};

/// Ball of 642 nodes (162 if quick), E 10 kPa, wall 3 mm, between frictionless plates that close to
/// 30 % of its diameter in 1 s, hold for 1.5 s, and open again in 0.5 s.
VolumeErrors squeeze_ball(const Method& method, bool quick);

struct StepLimits {
  double given = 0;     ///< OrganDynamics::largest_step() [s]
  double measured = 0;  ///< largest stable one; 0 if 0.1 ms is not stable [s]
};

/// Measured: the same ball, closed upon in 0.3 s and held for 0.2 s, keeps all node speeds below
/// kMaxSoundSpeed. Bisection to 2 % between 0.1 ms and kLongestTriedStep, each try a run from rest.
/// Deterministic. Above it some step may be stable again.
StepLimits step_limits(const Method& method, bool quick);
inline constexpr double kMaxSoundSpeed = 5;        // [m/s]; the plates move at up to 0.1
inline constexpr double kLongestTriedStep = 0.02;  // [s]

/// Undamped free vibration of the ball, set swinging as an ellipsoid (all volume kept) with a tenth
/// of its radius: mean energy over the last tenth of kVibrationTime over that of the first tenth,
/// minus 1, at h = kVibrationStep. Kinetic energy, springs, and what the method's contents store.
/// Not a number for a method without velocities.
double energy_drift(const Method& method, bool quick);
inline constexpr double kVibrationTime = 4, kVibrationStep = 5e-4;  // [s]

struct Cost {
  double step = 0;      ///< wall seconds, median
  double relative = 0;  ///< to plain mass-spring in alternation, median of the ratios
};

/// Of one step of the swinging ball, without contacts.
Cost step_cost(const Method& method, bool quick);

/// The scene's first organ with the method, in process, for `seconds` of simulated time.
/// @throws InputError
VolumeErrors press_organ(const Method& method, const scene::Scene& scene, double seconds);

}  // namespace palpate::volume_methods
