#include "palpate/session_monitor.h"

#include "modules/core/text.h"
#include "modules/core/units.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/name_claim.h"

namespace palpate::launcher {
namespace {

/// Statuses come four times a second.
constexpr std::int64_t kSilentAfterNs = 2 * kNanosecondsPerSecond;

bool takes_part(const ModuleStatus& status) {
  return status.state != ModuleState::kStarting && status.state != ModuleState::kFault &&
         status.state != ModuleState::kStopped;
}

/// It says why; a program that does ends soon.
bool refuses(const ModuleStatus& status) {
  const bool ended = status.state == ModuleState::kStopped && !status.last_error.empty();
  return ended || status.state == ModuleState::kFault;
}

}  // namespace

SessionMonitor::SessionMonitor(bus::Bus& bus, const scene::Scene& scene)
    : statuses_(bus.reader(bus::kModuleStatus)), tally_(scene) {}

void SessionMonitor::poll() {
  while (statuses_.take(status_)) {
    tally_.receive(status_, statuses_.writer());
    const std::int64_t now_ns = runtime::monotonic_now_ns();
    heard_ns_[status_.module] = now_ns;
    if (!runtime::may_be_several(status_.module))
      writers_[status_.module].hear(statuses_.writer(), now_ns);
  }
}

std::vector<std::string> SessionMonitor::several() const {
  std::vector<std::string> names;
  for (const auto& [name, writers] : writers_) {
    if (writers.several(runtime::monotonic_now_ns())) names.push_back(name);
  }
  return names;
}

/// Of one host they are refused (runtime::claim_module()).
std::vector<std::string> SessionMonitor::take_warnings() {
  constexpr const char* kSeveral =
      "several processes are it in this session, on several hosts or for several users: what it "
      "publishes jumps between theirs; end all but one";
  std::vector<std::string> lines;
  for (const auto& module : several()) {
    tally_.note_degraded(module, kSeveral);
    if (warned_.insert(module).second) lines.push_back(module + ": " + kSeveral);
  }
  return lines;
}

std::vector<std::string> SessionMonitor::silent() const {
  std::vector<std::string> names;
  for (const auto& [name, heard_ns] : heard_ns_) {
    if (runtime::monotonic_now_ns() - heard_ns > kSilentAfterNs) names.push_back(name);
  }
  return names;
}

std::vector<std::string> SessionMonitor::not_ready(const std::vector<std::string>& modules) const {
  std::vector<std::string> waiting;
  for (const auto& name : modules) {
    const ModuleTally* module = tally_.module(name);
    if (module == nullptr || !takes_part(module->newest)) waiting.push_back(name);
  }
  return waiting;
}

std::vector<std::string> SessionMonitor::waited_for(const std::vector<std::string>& modules) const {
  std::vector<std::string> in_the_way;
  for (const auto& name : modules) {
    const ModuleTally* module = tally_.module(name);
    if (module == nullptr) {
      in_the_way.push_back(name);
    } else if (refuses(module->newest)) {
      in_the_way.push_back(name + " (" + printable(module->newest.last_error) + ")");
    }
  }
  return in_the_way.empty() ? not_ready(modules) : in_the_way;
}

}  // namespace palpate::launcher
