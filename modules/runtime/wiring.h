// Who tells whom what, and how often: the one place that knows the session as a whole.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "modules/scene/scene.h"

namespace palpate::runtime {

/// The processes whose cycles are scheduled, in the order in which they work at one instant: each
/// uses what those before it said at that instant, and what those after it said before.
inline constexpr std::array<std::string_view, 5> kModules{"haptics", "collision", "deformation",
                                                          "visualizer", "recorder"};

/// A module that several processes share is named after its job, and from the second one on after
/// its number, too: "deformation", "deformation_2".
struct ModuleName {
  std::string_view job;     ///< one of kModules
  std::size_t process = 1;  ///< from 1
};
/// None if there is no such module in any scene.
std::optional<ModuleName> module_named(std::string_view name);
std::string name_of(const ModuleName& module);

/// Cycles per second of the recorder.
inline constexpr double kRecorderRate = 100;

/// One topic: who writes it, per what its keys are counted, who reads it.
struct Wire {
  enum class Keys { kOne, kProbes, kOrgans, kProbesOfProcesses };
  std::string_view topic;
  std::string_view writer;  ///< a module; empty: the launcher, an outside program, or everybody
  Keys keys = Keys::kOne;
  bool every_cycle = false;  ///< the writer says it once in each of its cycles
  std::array<std::string_view, 4> readers{};
};

/// All topics that carry a session's physics. Recorders read them all; statuses and commands are
/// the drivers' own.
std::span<const Wire> session_wires();
const Wire* find_wire(std::string_view topic);

/// The k-th cycle of a module begins at k periods [ns].
class CycleGrid {
 public:
  /// @param rate_hz  > 0
  explicit CycleGrid(double rate_hz);
  std::int64_t period_ns() const { return period_ns_; }
  /// The last beginning at or before a time, the last before it; before the first: kNever.
  std::int64_t last_at(std::int64_t time_ns) const;
  std::int64_t last_before(std::int64_t time_ns) const { return last_at(time_ns - 1); }

  /// The time of what is said before the first cycle.
  static constexpr std::int64_t kSetUp = -1;
  static constexpr std::int64_t kNever = kSetUp - 1;

 private:
  std::int64_t period_ns_;
};

/// Cycles per second of a module in this scene.
double rate_of(std::string_view module, const scene::Scene& scene);

/// Age from which probe states and contacts no longer tell the present: the scene's
/// haptics.stale_after, but at least kInputStaleAfter and two periods of who writes them [s].
double input_stale_after(const scene::Scene& scene);

/// Which samples a module's cycle must have.
class InputRule {
 public:
  InputRule(const scene::Scene& scene, std::string_view module);

  /// Samples of `topic` with later source times are not for the cycle at `time_ns` [ns].
  std::int64_t horizon(std::string_view topic, std::int64_t time_ns) const;
  /// The source time that each key of `topic` must have reached before the cycle at `time_ns`
  /// [ns]; nothing to wait for where it is kNever or the number of keys is 0.
  std::int64_t required(std::string_view topic, std::int64_t time_ns) const;
  std::size_t keys(std::string_view topic) const;
  /// Whether what one process says of it means the same before and after what another says.
  static bool comes_in_parts(std::string_view topic);

 private:
  bool writes_first(const Wire& wire) const;
  const scene::Scene& scene_;
  std::size_t rank_;  ///< in kModules
};

/// Whether a cycle of another participant waits for what `module` says in its cycle at `time_ns`,
/// and for nothing that it says later. Recorders wait for nobody's sake.
bool is_awaited(std::string_view module, std::int64_t time_ns, const scene::Scene& scene,
                const std::vector<std::string>& participants);

/// How many of `participants` read a topic.
int reader_count(std::string_view topic, const std::vector<std::string>& participants);

}  // namespace palpate::runtime
