// A hand holding a device against a virtual wall: a session in one process with the wall in the
// place of deformation and a link that delays. Where it ends to be stable: K = (b + B)/(T/2 + t_d),
// b the device's damping, T how long a force is held, t_d how old its data are; B, virtual damping,
// is 0 here (docs/haptic_safety.md).
#pragma once

#include "studies/stability/runs.h"

namespace palpate::stability {

struct Loop {
  double rate = 1000;        ///< of the haptic loop; T = 1/rate [Hz]
  bool local_model = false;  ///< a law f + K (anchor − x) crosses the link, else bare forces
  bool passivity = false;    ///< the whole of haptics with its defaults, else the bare law
};

inline constexpr double kHandMass = 0.1;     ///< [kg]
inline constexpr double kHandDamping = 0.2;  ///< b [N·s/m]

/// A new model every tick, `delay` old when a force is made of it. A constant push of up to 2.5 N
/// presses the device into the wall; kicked to 10 mm/s it must come to rest within 18 s: stable if
/// its motion over the last tenth is within 1 µm or 0.9 of that over the fourth (the formula's K
/// less 1 %), diverged if it leaves by 15 mm.
/// @param delay  [s], a multiple of T, at least one: nobody knows the pose of the same tick
/// @param stiffness  K [N/m]
Verdict close_loop(const Loop& loop, double delay, double stiffness, const KeepGoing& keep_going);

/// (b + B)/(T/2 + t_d) [N/m]; of a local model, whose law knows the present pose, t_d is 0.
double critical_stiffness(const Loop& loop, double delay);

}  // namespace palpate::stability
