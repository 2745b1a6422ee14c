// Hands that hold the device of a certificate.
#pragma once

#include "studies/certify/subject.h"

namespace palpate::certify {

inline constexpr double kAbove = 3e-3;  ///< where presses begin, above the place of touch [m]

/// Goes through `moves` of its target from above the place and yields little: 0.2 kg, 10 N·s/m,
/// 500 N/m, an arm that is held stiff.
scene::EmulatedDevice firm_hand(const scene::EmulatedDevice& device, const Place& place,
                                std::vector<scene::ScriptedDevice::Move> moves);

/// Pushes from the place of touch on with a constant force along `into` [N], where a rail keeps the
/// device, for pushed freely it slips off aside. Without mass or damping: nothing of the hand calms
/// it.
scene::EmulatedDevice pushing_hand(const scene::EmulatedDevice& device, const Place& place,
                                   double push);

/// t_d: from a pose to the force that answers it, beside the loop's tick [s].
double delay_of(const scene::EmulatedDevice& device);

}  // namespace palpate::certify
