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
  kContactsIgnored,
  kTissueInverted,
  kProbeJumped,
  kMessageRefused,
  kModelRefused
};
inline constexpr std::size_t kGuardCount = 16;
inline constexpr std::array<const char*, kGuardCount> kGuardNames{
    "not_finite",      "too_fast",        "energy_grew",     "too_large",
    "turned_inside",   "collapsed",       "back_to_rest",    "step_reduced",
    "pressure_capped", "volume_released", "volume_skipped",  "contacts_ignored",
    "tissue_inverted", "probe_jumped",    "message_refused", "model_refused"};

struct Outcome {
  Ending ending = Ending::kRan;
  std::array<std::uint32_t, kGuardCount> guards{};  ///< advances in which each acted
  double time = 0;                                  ///< simulated [s]
  std::string what;  ///< "kind: details" of a failure; the message of a refusal

  /// Of a failure: what stands before the colon.
  std::string kind() const { return what.substr(0, what.find(':')); }
};

}  // namespace palpate::fuzz
