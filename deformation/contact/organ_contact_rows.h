// From pairs of features that are near to contact rows, each place once.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "deformation/contact/confined_motion.h"
#include "deformation/contact/organ_contact_solve.h"

namespace palpate::deformation {

/// Organ and nodes of a row's places, those of a place in order: the same in every step.
using ContactKey = std::array<std::uint32_t, 8>;
ContactKey key_of(const OrganContactRow& row);

/// The contact of a pair in a step of h [s]; from the place with the lower key.
/// @param rest_gap  distance at which the places rest [m]
OrganContactRow row_between(const StepPair& step, double rest_gap, double friction, double h);

/// Sorts by key and leaves one row of each: places are found by several pairs, from either side.
void keep_each_once(std::vector<OrganContactRow>& rows);

/// What acts on the organ of one place, the other being a probe's.
/// @param side  0 or 1: whose
ContactRow seen_from(const OrganContactRow& row, std::size_t side,
                     std::span<const TouchedOrgan> organs);

}  // namespace palpate::deformation
