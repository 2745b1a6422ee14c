#include "palpate/session_monitor.h"

namespace palpate::launcher {

SessionMonitor::Physics::Physics(bus::Bus& bus)
    : positions(bus.reader(bus::kNodePositions)),
      forces(bus.reader(bus::kHapticForce)),
      laws(bus.reader(bus::kContactModel)) {}

SessionMonitor::SessionMonitor(bus::Bus& bus, const scene::Scene& scene, Hears hears)
    : statuses_(bus.reader(bus::kModuleStatus)), tally_(scene) {
  if (hears == Hears::kAll) hear_all(bus);
}

void SessionMonitor::poll() {
  while (statuses_.take(status_)) tally_.receive(status_);
  if (!physics_) return;
  while (physics_->positions.take(node_positions_)) tally_.receive(node_positions_);
  while (physics_->laws.take(law_)) tally_.receive(law_);
  while (physics_->forces.take(force_)) tally_.receive(force_);
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
