// A stage whose cycles are timed: what a module costs within its session.
#pragma once

#include <memory>

#include "modules/runtime/stage.h"

namespace palpate::session {

class TimedStage final : public runtime::Stage {
 public:
  /// @param clock    [s]: of the thread, the processor or the wall
  /// @param seconds  what all cycles took so far; outlives the stage
  TimedStage(std::unique_ptr<runtime::Stage> stage, double (*clock)(), double& seconds)
      : stage_(std::move(stage)), clock_(clock), seconds_(seconds) {}

  runtime::Health cycle(const runtime::Cycle& now) override {
    const double begin = clock_();
    const runtime::Health health = stage_->cycle(now);
    seconds_ += clock_() - begin;
    return health;
  }
  void finish(const runtime::Cycle& now) override { stage_->finish(now); }

 private:
  std::unique_ptr<runtime::Stage> stage_;
  double (*clock_)();
  double& seconds_;
};

}  // namespace palpate::session
