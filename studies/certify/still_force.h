// Is the force that a hand feels the organ's own? A hand presses in steps and waits; the organ
// alone, brought to rest at the same places, answers beside it.
#pragma once

#include "studies/certify/line.h"
#include "studies/certify/loop.h"

namespace palpate::certify {

/// Smallest difference of forces that a hand tells apart: X. D. Pang, H. Z. Tan, N. I. Durlach,
/// Perception & Psychophysics 49, 1991.
inline constexpr double kForceJnd = 0.07;

/// Of the organ alone, at rest with the probe at each of the places in turn, against `into` [N].
/// @param troubles  gets its own added; null: not counted
std::vector<double> still_forces(const Subject& subject, const std::vector<Vec3>& places,
                                 const KeepGoing& keep_going, ContactTroubles* troubles);

struct StillForce {
  double depth = 0;            ///< of the body [m]
  double felt = 0, organ = 0;  ///< [N]
};
/// Troubles of the organ alone count as those of the loop.
std::vector<StillForce> measure_still_force(const Loop& loop, const Subject& subject,
                                            const KeepGoing& keep_going);
Line still_force_line(const std::vector<StillForce>& forces);

}  // namespace palpate::certify
