// A wall that was put elsewhere at once, by another mesh or an earlier state, is moved off the
// cores of probes that were outside it: else they are inside, through no motion of anybody.
#pragma once

#include <span>

#include "deformation/model/body.h"

namespace palpate::deformation {

/// A round probe's core where it is; of a ball both ends are one [m].
struct CoreLine {
  Vec3 a, b;
};

/// Moves free nodes around the walls nearest to what of the cores is inside the closed surface,
/// until all along they are outside.
/// @param cores      that belong outside
/// @param positions  of all the body's nodes [m]
/// @returns whether they are outside
bool seat_outside(std::span<const CoreLine> cores, const Body& body, std::span<Vec3> positions);

}  // namespace palpate::deformation
