// Stages driven by their data: a cycle begins when its inputs have what they must have by then, and
// sees nothing later. No clock is read, so the same scene gives the same bits on any machine.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "modules/bus/bus.h"
#include "modules/runtime/stage.h"
#include "modules/runtime/wiring.h"

namespace palpate::runtime {

/// Where one module is in a lockstep session, and what its next cycle waits for.
class LockstepCursor {
 public:
  /// @param scene   outlives the cursor
  /// @param inputs  the module's own, alive as long as the cursor
  LockstepCursor(const scene::Scene& scene, const std::string& module,
                 std::vector<bus::Input*> inputs);

  /// When the next cycle begins, simulated [ns]; the first at 0.
  std::int64_t next_ns() const { return next_ns_; }
  /// An input that does not have yet what the next cycle needs; nullptr if none.
  bus::Input* missing() { return missing_at(next_ns_); }
  /// While `missing` is: lets the stage take what it reads before that, and what has come of it
  /// if it comes in parts.
  /// @returns what is missing then: what came meanwhile ends no wait
  bus::Input* prepare(Stage& stage, const bus::Input& missing);
  /// The next cycle of `stage`, with nothing missing.
  Health step(Stage& stage);

  /// The first cycle is that at or after `start_ns`. What was to be said before that, nobody says
  /// any more: it is not waited for.
  void begin_at(std::int64_t start_ns);
  /// Stage, outputs and inputs as they are when all cycles before `time_ns` are done and all said
  /// before it has come; when it reads, after begin_at().
  /// @param outputs  the module's own
  void exchange(StateArchive& archive, Stage& stage, std::span<bus::Output* const> outputs,
                std::int64_t time_ns);

  /// The same for the end of a session: all said before `end_ns` has come; then finish.
  bus::Input* missing_before_end(std::int64_t end_ns) { return missing_at(end_ns - 1); }
  void finish(Stage& stage, std::int64_t end_ns);

 private:
  /// Whether a cycle of that time waits for samples of the input, and then until when.
  std::optional<std::int64_t> awaited(const bus::Input& input, std::int64_t time_ns) const;
  bus::Input* missing_at(std::int64_t time_ns);
  void open_until(std::int64_t time_ns);

  InputRule rule_;
  CycleGrid grid_;
  std::vector<bus::Input*> inputs_;
  std::int64_t start_ns_ = 0, next_ns_ = 0;
  std::int64_t nothing_missing_ns_ = CycleGrid::kNever;  ///< when it was asked last
  std::int64_t prepared_ns_ = CycleGrid::kSetUp;         ///< for which cycle it was last, and
  const bus::Input* prepared_until_ = nullptr;           ///< before which input
};

}  // namespace palpate::runtime
