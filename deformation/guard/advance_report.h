// What the guards of an organ saw and did in an advance, by codes.
#pragma once

#include <cstdint>

namespace palpate::deformation {

/// Which bound a state violates.
enum class Violation : std::uint8_t {
  kNone,
  kNotFinite,     ///< a position, velocity, pressure or impulse
  kTooFast,       ///< a node beyond kMaxNodeSpeed, now or on the way since the last check
  kEnergyGrew,    ///< beyond kEnergyGain times what it had and was given
  kTooLarge,      ///< two nodes further apart than kMaxGrowth times any two at rest
  kTurnedInside,  ///< it encloses less than −kTurnedVolume V₀
  kCollapsed      ///< flattened to a line or point, or a solid folded, for kCollapsedTime
};

/// What an advance had to do beyond stepping. Never silent: the process publishes it.
struct AdvanceReport {
  bool diverged = false;                 ///< a state was implausible and replaced
  Violation reason = Violation::kNone;   ///< of that
  bool back_to_rest = false;             ///< replaced by the rest state, not the last good one
  bool step_reduced = false;             ///< steps are shorter than stability should need
  bool pressure_capped = false;          ///< the cap was met: V* goes on from V
  bool volume_released = false;          ///< V was far from V*: V* follows V from there
  bool volume_skipped = false;           ///< gᵀM⁻¹g vanished: volume not corrected there
  bool contacts_suspended = false;       ///< of an organ put back to rest, for kQuietTime
  bool tissue_inverted = false;          ///< some tetrahedra of a solid are turned inside out
  bool contact_refused = false;          ///< it was too far from its tissue to be one
  bool law_bounded = false;              ///< a law before it: RowStiffness::bounded
  bool mesh_coarser = false;             ///< under a probe than asked for: as many nodes as may be
  bool probe_jumped = false;             ///< a probe moved faster than is plausible: no contacts
  bool organ_motion_cut = false;         ///< surfaces about to cross were held for a step
  bool organ_contacts_unsolved = false;  ///< of organs: their sweeps were cut
  int contacts_unsolved = 0;             ///< steps that ended with a probe deeper than it may be
};

}  // namespace palpate::deformation
