// Which guard of a world acts now, and how often it has.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "deformation/guard/advance_report.h"
#include "modules/core/state_archive.h"

namespace palpate::deformation {

/// What a guard did, from harsh to mild.
enum class GuardCode : std::uint8_t {
  kBackToRest,  ///< a state was replaced by the rest state
  kNotFinite,   ///< this and the next five: replaced by the last good state, for this reason
  kTooFast,
  kTooLarge,
  kTurnedInside,
  kCollapsed,
  kEnergyGrew,
  kContactsSuspended,  ///< from here on as in AdvanceReport
  kPressureCapped,
  kVolumeReleased,
  kVolumeSkipped,
  kTissueInverted,
  kContactRefused,
  kProbeJumped,
  kOrganMotionCut,
  kOrganContactsUnsolved,
  kContactsUnsolved,
  kStepReduced,
  kLawBounded,
  kMeshCoarser,
  kNone
};
inline constexpr auto kGuardCodes = static_cast<std::size_t>(GuardCode::kNone);

struct GuardEvent {
  GuardCode code = GuardCode::kNone;
  std::uint64_t times = 0;  ///< it has acted, this time among them
};

class GuardLog {
 public:
  /// A guard that acts again within this time goes on acting; after it, it acts once more [s].
  static constexpr double kSameEvent = 1.0;

  GuardLog() { reset(); }
  void reset();

  /// The harshest guard of the advance that ended at simulated `time` [s].
  GuardEvent note(const AdvanceReport& report, double time);

  void exchange(StateArchive& archive) { archive(counts_); }

 private:
  struct Count {
    std::uint64_t events = 0;
    double last_time = 0;  ///< [s]
    void exchange(StateArchive& archive) { archive(events, last_time); }
  };
  std::array<Count, kGuardCodes> counts_;
};

}  // namespace palpate::deformation
