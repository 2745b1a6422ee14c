#include "deformation/guard_text.h"

#include <algorithm>
#include <cstdio>

namespace palpate::deformation {
namespace {

struct Text {
  GuardCode code;
  const char* text;
};

constexpr std::array<Text, kGuardCodes> kTexts{{
    {GuardCode::kBackToRest,
     "an organ diverged again and again: it was put back to its rest state"},
    {GuardCode::kNotFinite,
     "an organ diverged (a number not finite): its last good state was restored, at rest"},
    {GuardCode::kTooFast,
     "an organ diverged (a node above 100 m/s): its last good state was restored, at rest"},
    {GuardCode::kTooLarge,
     "an organ diverged (grown to 5 times its size): its last good state was restored, at rest"},
    {GuardCode::kTurnedInside,
     "an organ was turned inside out: its last good state was restored, at rest"},
    {GuardCode::kCollapsed,
     "an organ collapsed or folded and did not unfold: its last good state was restored, at rest"},
    {GuardCode::kEnergyGrew,
     "an organ diverged (more energy than it was given): its last good state was restored, at "
     "rest"},
    {GuardCode::kContactsSuspended,
     "an organ put back to its rest state takes no contacts for a second"},
    {GuardCode::kPressureCapped, "an organ's pressure met its cap: its target volume gives way"},
    {GuardCode::kVolumeReleased,
     "an organ's volume was off by more than 5 %: it is brought back slowly"},
    {GuardCode::kVolumeSkipped, "an organ is too flat for its volume to be corrected"},
    {GuardCode::kTissueInverted,
     "tissue is squeezed inside out in places: forces there are not to be believed"},
    {GuardCode::kContactRefused, "a contact metres away from its tissue was not believed"},
    {GuardCode::kProbeJumped, "a probe jumped: its contacts were dropped"},
    {GuardCode::kOrganMotionCut,
     "organs would have passed through each other or themselves: they were held for a step"},
    {GuardCode::kOrganContactsUnsolved,
     "contacts between organs were not solved to the end in a step"},
    {GuardCode::kContactsUnsolved,
     "contacts were not solved to the end in a step: tissue is deeper in a probe than it may be"},
    {GuardCode::kStepReduced,
     "an organ held more energy than it was given: its steps are shortened"},
    {GuardCode::kLawBounded,
     "a sliding touch would have been stiffer than a sticking one, or no stiffness was found"},
    {GuardCode::kMeshCoarser,
     "a solid has as many nodes as it may ('nodes'): under a probe it is coarser than asked for"},
}};

}  // namespace

const char* GuardText::of(const GuardEvent& event) {
  const auto found = std::ranges::find(kTexts, event.code, &Text::code);
  if (found == kTexts.end()) return "";
  if (event.times <= 1) return found->text;
  std::snprintf(text_.data(), text_.size(), "%s (%llu times)", found->text,
                static_cast<unsigned long long>(event.times));
  return text_.data();
}

const char* acting_guard(const char* of_world, double real_time_factor, bool silent_input) {
  if (*of_world != '\0') return of_world;
  if (silent_input) return "a probe or its contacts are stale: the hand feels nothing of it";
  if (real_time_factor < 0.95) return "slower than real time: see the real-time factor";
  return "";
}

}  // namespace palpate::deformation
