// A wall is moved off the cores of probes that were outside it: where it was put elsewhere at once,
// by another mesh or an earlier state, and where a step that no row held took it across one.
#pragma once

#include <span>

#include "deformation/model/body.h"

namespace palpate::deformation {

/// A round probe's core where it is; of a ball both ends are one [m].
struct CoreLine {
  Vec3 a, b;
};

/// Whether all of the cores, all along, are outside the closed surface: exact, a look at each
/// triangle for each.
bool are_outside(std::span<const CoreLine> cores, const Body& body,
                 std::span<const Vec3> positions);

/// Moves free nodes around the walls nearest to what of the cores is inside the closed surface,
/// until all along they are outside.
/// @param cores      that belong outside
/// @param positions  of all the body's nodes [m]
/// @returns whether they are outside
bool seat_outside(std::span<const CoreLine> cores, const Body& body, std::span<Vec3> positions);

}  // namespace palpate::deformation
