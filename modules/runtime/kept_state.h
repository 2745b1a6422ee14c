// What a process remembers, kept where its successor finds it when it is killed: in a file without
// a name, in memory, which outlives it because who starts both holds it (KeptMemory).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "modules/runtime/session_state.h"
#include "modules/runtime/stage.h"

namespace palpate::runtime {

/// The file, of whoever starts the process: empty until it is written. Inherited by none but who
/// is told of it.
class KeptMemory {
 public:
  /// @throws std::runtime_error if there is no memory for it
  KeptMemory();
  ~KeptMemory();
  KeptMemory(const KeptMemory&) = delete;
  KeptMemory& operator=(const KeptMemory&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

class KeptState {
 public:
  static constexpr double kEvery = 0.1;  ///< between two times that it is kept [s]
  /// A successor that ends sooner after it took what was kept may have ended of that: the next one
  /// begins at rest [s].
  static constexpr double kTrusted = 1.0;

  /// @param descriptor  of the file; none: nothing is kept
  /// @param scene_digest  what another scene's process kept is not taken
  KeptState(std::optional<int> descriptor, std::string scene_digest);

  /// The stage, just made, goes on where its predecessor's was when that was last kept.
  /// @returns its age [s]; none: nothing was kept, or it is not to be trusted
  /// @throws std::runtime_error if it cannot be read: the stage is not to be used
  std::optional<double> give_back(Stage& stage, std::int64_t now_ns);
  /// Before a cycle: tells a stage that goes on so, and of a reset that it slept through.
  void tell(const SessionControl& last_command, Cycle& now);
  /// After a cycle: keeps what the stage remembers, if it is time. Who is killed in the middle of
  /// it leaves what was kept before.
  void keep(Stage& stage, const SessionControl& last_command, std::int64_t now_ns);

 private:
  struct Contents;
  /// What the file begins with: where it is. Written at once, after it.
  struct Mark {
    std::uint64_t words = 0, place = 0, size = 0;
    std::uint64_t taken = 0;  ///< times since the process that kept it had gone on for kTrusted
  };
  bool write(const void* bytes, std::size_t size, std::uint64_t at);

  int descriptor_;
  std::string scene_digest_;
  Mark mark_;
  std::optional<std::uint32_t> reset_count_;  ///< of what was given back, until a command tells
  bool tells_ = false;                        ///< that it was given back
  std::int64_t began_ns_ = 0, kept_ns_ = 0;
  std::vector<std::uint8_t> memory_;  ///< of an archive
};

}  // namespace palpate::runtime
