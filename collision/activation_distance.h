// How far ahead contacts have to be looked for.
#pragma once

#include <algorithm>

#include "modules/scene/scene.h"

namespace palpate::collision {

/// The next contacts arrive one period of collision and one of deformation later [s].
inline double blind_time(const scene::Rates& rates) {
  return 1 / rates.collision + 1 / rates.deformation;
}

/// The margin is the distance probe and tissue can close in that time. In it the probe moves by
/// speed × (T_collision + T_deformation), doubled because it may accelerate, and tissue swings
/// towards it at up to 0.125 m/s. The margin is at least a millimetre because processes are late at
/// times. Tissue that entered a probe unseen would be thrown out again, step after step.
/// @param speed  of the probe [m/s]. @return [m]
inline double activation_distance(const scene::Rates& rates, double speed) {
  constexpr double kTissueSpeed = 0.125, kLeastAllowance = 1e-3;  // [m/s], [m]
  const double blind = blind_time(rates);
  return std::max(kTissueSpeed * blind, kLeastAllowance) + 2 * speed * blind;
}

}  // namespace palpate::collision
