// A wall that was put elsewhere at once, by another mesh or an earlier state, is moved off the
// cores of probes that were outside it: else they are inside, through no motion of anybody.
#pragma once

#include <span>
#include <vector>

#include "deformation/model/body.h"

namespace palpate::deformation {

/// Moves free nodes around the walls nearest to points inside the closed surface, until the points
/// are outside.
/// @param points     that belong outside [m]
/// @param positions  of all the body's nodes [m]
/// @returns whether they are outside
bool seat_outside(std::span<const Vec3> points, const Body& body, std::span<Vec3> positions);

}  // namespace palpate::deformation
