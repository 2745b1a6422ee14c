// What a sharp tool has inside: where a wall that is seen there has gone through it.
#pragma once

#include <vector>

#include "modules/geometry/probe_form.h"

namespace palpate::geometry {

/// How far below a tool's surface [m].
/// @param least_extent  of the tool [m]
double inner_inset(double least_extent);

/// Thin capsules within a tool, close to its surface: of a box its edges and the middle lines of
/// its faces, of a closed surface lines between places near nodes that are far from each other.
/// None of others. In P [m].
std::vector<RoundedSegment> inner_lines(const ProbeForm& form);

}  // namespace palpate::geometry
