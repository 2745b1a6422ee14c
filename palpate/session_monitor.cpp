#include "palpate/session_monitor.h"

namespace palpate::launcher {

SessionMonitor::SessionMonitor(bus::Bus& bus, const scene::Scene& scene)
    : statuses_(bus.reader(bus::kModuleStatus)),
      positions_(bus.reader(bus::kNodePositions)),
      forces_(bus.reader(bus::kHapticForce)),
      laws_(bus.reader(bus::kContactModel)),
      tally_(scene) {}

void SessionMonitor::poll() {
  while (statuses_.take(status_)) tally_.receive(status_);
  while (positions_.take(node_positions_)) tally_.receive(node_positions_);
  while (laws_.take(law_)) tally_.receive(law_);
  while (forces_.take(force_)) tally_.receive(force_);
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

}  // namespace palpate::launcher
