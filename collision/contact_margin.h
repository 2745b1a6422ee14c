// How far ahead contacts have to be looked for.
#pragma once

#include "modules/scene/scene.h"

namespace palpate::collision {

/// Contacts found now are used until the next search has reached deformation: one period of each.
/// Until then the probe moves by speed × (T_collision + T_deformation), doubled for a probe that
/// accelerates; and tissue swings towards it by a millimetre (a speed of 0.1 m/s at the default
/// rates). @param speed  of the probe [m/s]. @return [m]
inline double contact_margin(const scene::Rates& rates, double speed) {
  constexpr double kTissueAllowance = 1e-3;
  return kTissueAllowance + 2 * speed * (1 / rates.collision + 1 / rates.deformation);
}

}  // namespace palpate::collision
