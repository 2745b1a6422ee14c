// How far ahead contacts have to be looked for.
#pragma once

#include <algorithm>

#include "modules/scene/scene.h"

namespace palpate::collision {

/// Contacts found now are used until the next search has reached deformation: one period of each.
/// Until then the probe moves by speed × (T_collision + T_deformation), doubled for a probe that
/// accelerates; and tissue swings towards it at 0.125 m/s. What enters a probe unseen is pushed out
/// in a hurry, again and again. Not less than a millimetre: processes are late at times.
/// @param speed  of the probe [m/s]. @return [m]
inline double contact_margin(const scene::Rates& rates, double speed) {
  constexpr double kTissueSpeed = 0.125, kLeastAllowance = 1e-3;  // [m/s], [m]
  const double blind_time = 1 / rates.collision + 1 / rates.deformation;
  return std::max(kTissueSpeed * blind_time, kLeastAllowance) + 2 * speed * blind_time;
}

}  // namespace palpate::collision
