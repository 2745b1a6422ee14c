// What the guards of a world did, in words for the status: which acts now, and how often it has.
#pragma once

#include <array>
#include <cstdint>

#include "deformation/simulated_organ.h"

namespace palpate::deformation {

class GuardLog {
 public:
  /// A guard that acts again within this time goes on acting; after it, it acts once more [s].
  static constexpr double kSameEvent = 1.0;

  GuardLog() { reset(); }
  void reset();

  /// The harshest guard of the advance that ended at simulated `time` [s]; empty if none acted.
  /// Valid until the next call. Allocates nothing.
  const char* describe(const AdvanceReport& report, double time);

  static constexpr std::size_t kKinds = 15;

 private:
  struct Count {
    std::uint64_t events = 0;
    double last_time = 0;  ///< [s]
  };
  std::array<Count, kKinds> counts_;
  std::array<char, 200> text_{};
};

}  // namespace palpate::deformation
