#include "modules/runtime/lockstep.h"

namespace palpate::runtime {

LockstepCursor::LockstepCursor(const scene::Scene& scene, const std::string& module,
                               std::vector<bus::Input*> inputs)
    : rule_(scene, module), grid_(rate_of(module, scene)), inputs_(std::move(inputs)) {
  open_until(CycleGrid::kSetUp);
}

std::optional<std::int64_t> LockstepCursor::awaited(const bus::Input& input,
                                                    std::int64_t time_ns) const {
  const std::string_view topic = input.topic().name;
  const std::int64_t required = rule_.required(topic, time_ns);
  if (rule_.keys(topic) == 0 || required == CycleGrid::kNever) return {};
  if (required > CycleGrid::kSetUp && required < start_ns_) return {};
  return required;
}

/// The first one: stages read first what is said first. So it is read while others still work on
/// what comes last, for which everybody waits.
bus::Input* LockstepCursor::missing_at(std::int64_t time_ns) {
  for (bus::Input* input : inputs_) {
    const auto required = awaited(*input, time_ns);
    if (required && !input->heard_until(*required, rule_.keys(input->topic().name))) return input;
  }
  nothing_missing_ns_ = time_ns;
  return nullptr;
}

void LockstepCursor::open_until(std::int64_t time_ns) {
  for (bus::Input* input : inputs_) {
    // Of what no cycle waits for, such as states, more may come.
    const bool all_heard = nothing_missing_ns_ == time_ns &&
                           awaited(*input, time_ns).value_or(CycleGrid::kSetUp) > CycleGrid::kSetUp;
    input->set_horizon(rule_.horizon(input->topic().name, time_ns), all_heard);
  }
}

void LockstepCursor::begin_at(std::int64_t start_ns) {
  const std::int64_t period_ns = grid_.period_ns();
  start_ns_ = start_ns;
  next_ns_ = (start_ns + period_ns - 1) / period_ns * period_ns;
}

/// The outputs come last: a stage that reads may say states, which were said before.
void LockstepCursor::exchange(StateArchive& archive, Stage& stage,
                              std::span<bus::Output* const> outputs, std::int64_t time_ns) {
  archive(stage);
  archive.same(outputs.size());
  for (bus::Output* output : outputs) archive(*output);
  archive.same(inputs_.size());
  for (bus::Input* input : inputs_) input->exchange(archive, time_ns);
}

bus::Input* LockstepCursor::prepare(Stage& stage, const bus::Input& missing) {
  const bool in_parts = InputRule::comes_in_parts(missing.topic().name);
  const bool again = prepared_ns_ == next_ns_ && prepared_until_ == &missing;
  prepared_ns_ = next_ns_;
  prepared_until_ = &missing;
  if (!again || in_parts) {
    for (bus::Input* input : inputs_) {
      if (input == &missing && !in_parts) break;
      input->set_horizon(rule_.horizon(input->topic().name, next_ns_));
      if (input == &missing) break;
    }
    stage.prepare();
  }
  return missing_at(next_ns_);
}

Health LockstepCursor::step(Stage& stage) {
  open_until(next_ns_);
  Cycle now;
  now.sim_time_ns = now.now_ns = next_ns_;
  now.running = true;
  now.advance = seconds_from_ns(grid_.period_ns());
  const Health health = stage.cycle(now);
  next_ns_ += grid_.period_ns();
  return health;
}

void LockstepCursor::finish(Stage& stage, std::int64_t end_ns) {
  open_until(end_ns - 1);
  Cycle now;
  now.sim_time_ns = now.now_ns = end_ns - 1;
  stage.finish(now);
}

}  // namespace palpate::runtime
