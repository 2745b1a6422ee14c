// What a run of steps showed: whether it stood, and if not, how it failed.
#pragma once

#include <string>
#include <vector>

namespace palpate::stability {

enum class State {
  kStable,
  kOscillating,  ///< bounded, but most of its motion turns round in every step, or never dies down
  kDrifting,     ///< smooth, but its energy or volume goes away from what it should be
  kDiverged      ///< no number, or more energy or displacement than anything honest has
};

const char* name_of(State state);

/// The integrator stands: what is wrong, if anything, is accuracy.
inline bool holds(State state) { return state == State::kStable || state == State::kDrifting; }

/// One number per step, and the shape at the end.
struct Signals {
  std::vector<double> energy;        ///< that must not grow [J]
  std::vector<double> kinetic;       ///< [J]
  std::vector<double> turning;       ///< −cosine between velocities before and after, by mass
  std::vector<double> volume_error;  ///< |V − V*|/V*
  std::vector<double> displacement;  ///< largest of a node, over the organ's radius
  double inverted = 0;               ///< share of triangles or tetrahedra that face inwards
};

/// What the signals are held against; kAnything where a thing does not matter.
struct Tolerance {
  double energy = 0;        ///< the most an honest run has [J]
  double energy_drift = 0;  ///< of the last tenth's mean against the first's, allowed
  double volume_drift = 0;  ///< mean of the last tenth, allowed
  bool may_turn = false;    ///< turning round in every step is no fault: exact motion does where a
                            ///< step is about half a period
};
inline constexpr double kAnything = 1e300;

inline constexpr double kDivergedGain = 10;          ///< times Tolerance::energy
inline constexpr double kDivergedDisplacement = 10;  ///< radii
inline constexpr double kDivergedInversion = 0.5;    ///< share
inline constexpr double kStill = 1e-4;  ///< kinetic energy below this part of the tolerance's rests

struct Verdict {
  State state = State::kStable;
  double energy = 0;        ///< largest, over the tolerance's
  double volume_error = 0;  ///< mean of the last tenth
  double inverted = 0;      ///< share at the end
  double displacement = 0;  ///< largest [radii]
};

/// Whether the last step of `signals` already is beyond hope.
bool is_lost(const Signals& signals, const Tolerance& tolerance);

/// In this order: diverged, oscillating (over the last tenth), drifting, stable.
/// @param signals  of at least one step
Verdict judge(const Signals& signals, const Tolerance& tolerance);

}  // namespace palpate::stability
