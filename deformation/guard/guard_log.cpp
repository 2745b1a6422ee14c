#include "deformation/guard/guard_log.h"

namespace palpate::deformation {
namespace {

bool acted(GuardCode code, const AdvanceReport& r) {
  const auto replaced = [&](Violation reason) { return r.diverged && r.reason == reason; };
  switch (code) {
    case GuardCode::kBackToRest:
      return r.back_to_rest;
    case GuardCode::kNotFinite:
      return replaced(Violation::kNotFinite);
    case GuardCode::kTooFast:
      return replaced(Violation::kTooFast);
    case GuardCode::kTooLarge:
      return replaced(Violation::kTooLarge);
    case GuardCode::kTurnedInside:
      return replaced(Violation::kTurnedInside);
    case GuardCode::kCollapsed:
      return replaced(Violation::kCollapsed);
    case GuardCode::kEnergyGrew:
      return replaced(Violation::kEnergyGrew);
    case GuardCode::kContactsSuspended:
      return r.contacts_suspended;
    case GuardCode::kPressureCapped:
      return r.pressure_capped;
    case GuardCode::kVolumeReleased:
      return r.volume_released;
    case GuardCode::kVolumeSkipped:
      return r.volume_skipped;
    case GuardCode::kTissueInverted:
      return r.tissue_inverted;
    case GuardCode::kContactRefused:
      return r.contact_refused;
    case GuardCode::kProbeJumped:
      return r.probe_jumped;
    case GuardCode::kOrganMotionCut:
      return r.organ_motion_cut;
    case GuardCode::kOrganContactsUnsolved:
      return r.organ_contacts_unsolved;
    case GuardCode::kContactsUnsolved:
      return r.contacts_unsolved > 0;
    case GuardCode::kStepReduced:
      return r.step_reduced;
    case GuardCode::kLawBounded:
      return r.law_bounded;
    case GuardCode::kMeshCoarser:
      return r.mesh_coarser;
    case GuardCode::kNone:
      break;
  }
  return false;
}

}  // namespace

void GuardLog::reset() { counts_.fill({0, -2 * kSameEvent}); }

GuardEvent GuardLog::note(const AdvanceReport& report, double time) {
  GuardEvent harshest;
  for (std::size_t k = kGuardCodes; k-- > 0;) {
    const auto code = static_cast<GuardCode>(k);
    if (!acted(code, report)) continue;
    Count& count = counts_[k];
    if (time - count.last_time > kSameEvent) ++count.events;
    count.last_time = time;
    harshest = {code, count.events};
  }
  return harshest;
}

}  // namespace palpate::deformation
