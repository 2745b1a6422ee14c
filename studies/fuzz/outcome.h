// What became of a random scene.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace palpate::fuzz {

enum class Ending : std::uint8_t { kRan, kRefused, kFailed };

/// Guarded events: seen and said, thus no failures.
enum class Guard : std::uint8_t {
  kNotFinite,
  kTooFast,
  kEnergyGrew,
  kTooLarge,
  kTurnedInside,
  kCollapsed,
  kBackToRest,
  kStepReduced,
  kPressureCapped,
  kVolumeReleased,
  kVolumeSkipped,
  kContactsSuspended,
  kTissueInverted,
  kProbeJumped,
  kMessageRefused,
  kForceNotFinite,
  kContactsTruncated,
  kContactsLost,
  kContactsUnsolved
};
inline constexpr std::size_t kGuardCount = 19;
inline constexpr std::array<const char*, kGuardCount> kGuardNames{
    "not_finite",         "too_fast",        "energy_grew",      "too_large",
    "turned_inside",      "collapsed",       "back_to_rest",     "step_reduced",
    "pressure_capped",    "volume_released", "volume_skipped",   "contacts_suspended",
    "tissue_inverted",    "probe_jumped",    "message_refused",  "force_not_finite",
    "contacts_truncated", "contacts_lost",   "contacts_unsolved"};

/// What became of a scene in which a guard of the state acted (acts_on_state()) without any.
enum class Unguarded : std::uint8_t { kNotTried, kFine, kFailed };

/// Whether it changes what an organ does: its state, its steps or its V*. The others only say what
/// is, refuse a message, or drop contacts.
inline bool acts_on_state(Guard guard) { return guard <= Guard::kVolumeReleased; }

/// Of what a module publishes.
struct Failure {
  std::string what;  ///< "kind: details"
};

struct Outcome {
  Ending ending = Ending::kRan;
  Unguarded unguarded = Unguarded::kNotTried;
  std::array<std::uint32_t, kGuardCount> guards{};  ///< cycles in which each acted
  double time = 0;                                  ///< simulated [s]
  std::string what;  ///< "kind: details" of a failure; the message of a refusal

  bool any_guard_of_state() const {
    for (std::size_t g = 0; g < kGuardCount; ++g) {
      if (guards[g] > 0 && acts_on_state(static_cast<Guard>(g))) return true;
    }
    return false;
  }

  /// Of a failure: what stands before the colon.
  std::string kind() const { return what.substr(0, what.find(':')); }
};

}  // namespace palpate::fuzz
