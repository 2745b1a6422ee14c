#include "modules/runtime/run_stage.h"

#include <spdlog/spdlog.h>

#include <optional>

#include "modules/core/units.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/cycle_budget.h"
#include "modules/runtime/joined_streams.h"
#include "modules/runtime/kept_state.h"
#include "modules/runtime/name_claim.h"
#include "modules/runtime/realtime.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/scene_reader.h"

namespace palpate::runtime {
namespace {

Cycle cycle_of(Module& module) {
  Cycle now;
  now.sim_time_ns = ns_from_seconds(module.time());
  now.now_ns = module.now_ns();
  now.computed_ns = thread_time_ns();
  now.running = module.running();
  now.reset = module.take_reset();
  now.joined = module.joined();
  now.advance = module.period();
  return now;
}

/// Asked at most so often: DDS answers under locks [ns].
constexpr std::int64_t kJoinedAskedEveryNs = kNanosecondsPerSecond / 50;
/// Who is not heard by then takes no part: a session of some modules starts, too. Discovery takes
/// half a second [ns].
constexpr std::int64_t kJoinedWithinNs = 3 * kNanosecondsPerSecond;

/// Ready once the stage is and its streams are joined, or have been waited for; from then on
/// whatever happens.
class Readiness {
 public:
  Readiness(const scene::Scene& scene, std::string_view name) : scene_(scene), name_(name) {}

  bool now(Module& module, bool stage_ready) {
    if (joined_ || !stage_ready || module.now_ns() < ask_at_ns_) return joined_ && stage_ready;
    if (give_up_ns_ == 0) give_up_ns_ = module.now_ns() + kJoinedWithinNs;
    ask_at_ns_ = module.now_ns() + kJoinedAskedEveryNs;
    joined_ = module.now_ns() >= give_up_ns_ || are_streams_joined(module.bus(), scene_, name_);
    return joined_;
  }

 private:
  const scene::Scene& scene_;
  std::string_view name_;
  std::int64_t ask_at_ns_ = 0, give_up_ns_ = 0;
  bool joined_ = false;
};

void run_in_real_time(Module& module, Stage& stage, Readiness readiness, KeptState& kept) {
  std::optional<CycleBudget> budget;
  while (module.next_cycle()) {
    Cycle now = cycle_of(module);
    kept.tell(module.session().state().last_command(), now);
    if (budget) now.advance = budget->next();
    const Health health = stage.cycle(now);
    if (budget && now.running) {
      budget->took(now.advance, seconds_from_ns(monotonic_now_ns() - now.now_ns));
    }
    if (!budget && health.least_advance > 0) {
      budget.emplace(module.period(), health.least_advance);
    }
    if (readiness.now(module, health.ready)) module.ready();
    module.set_guard(health.guard);
    module.set_real_time_factor(health.real_time_factor);
    module.set_contact_troubles(health.contacts);
    module.set_extremes(health.organs, health.probes);
    if (health.finished) return;
    kept.keep(stage, module.session().state().last_command(), monotonic_now_ns());
  }
}

/// Who takes longer to take leave does not get it [ns].
constexpr std::int64_t kLeaveWithinNs = kNanosecondsPerSecond / 2;

void take_leave(Module& module, Stage& stage) {
  const std::int64_t until_ns = monotonic_now_ns() + kLeaveWithinNs;
  do {
    module.wait_for_period();
  } while (!stage.take_leave(cycle_of(module)) && module.now_ns() < until_ns);
}

}  // namespace

void run_stage(const ModuleOptions& options, const scene::Scene& scene, const std::string& name,
               Priority priority, const MakeStage& make) {
  spdlog::set_pattern("[" + name + "] %l: %v");  // of several processes of a program, which one
  const auto alone = claim_module(options.bus, name);
  if (!options.lockstep.empty()) return run_in_lockstep(options, scene, name, make);
  // Before there are threads of DDS, which then do so, too: those of deformation, where the first
  // core is its main thread's, would take a tenth of it.
  if (name != "visualizer") leave_first_core(scene.deformation_threads);
  Module module(options, scene, name, rate_of(name, scene), priority);
  const auto stage = make(module.bus());
  KeptState kept(options.kept_state, scene::scene_digest(scene));
  if (const auto age = kept.give_back(*stage, monotonic_now_ns())) {
    spdlog::info("goes on from what its predecessor remembered {:.2f} s ago", *age);
  }
  run_in_real_time(module, *stage, {scene, name}, kept);
  take_leave(module, *stage);
}

}  // namespace palpate::runtime
