#include "palpate/session_monitor.h"

namespace palpate::launcher {

SessionMonitor::SessionMonitor(bus::Bus& bus, const scene::Scene& scene)
    : statuses_(bus.reader(bus::kModuleStatus)), tally_(scene) {}

void SessionMonitor::poll() {
  while (statuses_.take(status_)) tally_.receive(status_);
}

std::vector<std::string> SessionMonitor::not_ready(const std::vector<std::string>& modules) const {
  std::vector<std::string> waiting;
  for (const auto& name : modules) {
    const ModuleTally* module = tally_.module(name);
    if (module == nullptr || module->newest.state == ModuleState::kStarting)
      waiting.push_back(name);
  }
  return waiting;
}

std::vector<std::string> SessionMonitor::waited_for(const std::vector<std::string>& modules) const {
  std::vector<std::string> unheard;
  for (const auto& name : modules) {
    if (tally_.module(name) == nullptr) unheard.push_back(name);
  }
  return unheard.empty() ? not_ready(modules) : unheard;
}

}  // namespace palpate::launcher
