// The force on a probe and how it varies with its pose, over all organs it touches.
#pragma once

#include <span>

#include "deformation/contact/probe_contacts.h"
#include "deformation/world_organ.h"

namespace palpate::deformation {

/// The local law of a probe at the end of an advance, but for its growth. Costs a small
/// factorisation.
/// @param period  of the advance [s]; 0, before the first: no rows
/// @param bounded  out, if not null: its stiffness was bounded, or not found (contact_law.h)
LocalLaw law_of_probe(std::span<WorldOrgan> organs, std::span<const ProbeContacts> probes,
                      std::size_t index, double period, bool* bounded);

/// How much too large the force on the probe is because of the solids' meshes, 0 … 1
/// (estimated_force_error()); 0: it presses on none whose model tells it.
double force_error_of_probe(std::span<const WorldOrgan> organs, const ProbeContacts& probe);

/// The same law of a probe that touches nothing, or of which nobody knows what it touches.
LocalLaw without_rows(const LocalLaw& law);

}  // namespace palpate::deformation
