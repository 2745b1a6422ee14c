// Hears a session for its tally.
#pragma once

#include <optional>

#include "modules/bus/bus.h"
#include "palpate/session_tally.h"

namespace palpate::launcher {

class SessionMonitor {
 public:
  enum class Hears { kAll, kStatuses };

  SessionMonitor(bus::Bus& bus, const scene::Scene& scene, Hears hears = Hears::kAll);

  /// Hears all from now on. In lockstep a module is ready when so many readers have met its writers
  /// as take part: one that looks on may not be counted in the place of another, which would miss
  /// what is said first.
  void hear_all(bus::Bus& bus) { physics_.emplace(bus); }

  /// Takes what has arrived. Called at the rate of the node positions it misses none of them.
  void poll();

  /// Names of modules whose state is not yet kReady or beyond (nothing heard, starting).
  std::vector<std::string> not_ready(const std::vector<std::string>& modules) const;
  /// Whom these wait for: who has not been heard; the others may wait for them. If all were heard,
  /// those that are not ready.
  std::vector<std::string> waited_for(const std::vector<std::string>& modules) const;

  SessionTally& tally() { return tally_; }
  const SessionTally& tally() const { return tally_; }

 private:
  struct Physics {
    explicit Physics(bus::Bus& bus);

    bus::Reader<NodePositions> positions;
    bus::Reader<HapticForce> forces;
    bus::Reader<ContactModel> laws;
  };

  bus::Reader<ModuleStatus> statuses_;
  std::optional<Physics> physics_;
  ModuleStatus status_;
  NodePositions node_positions_;
  HapticForce force_;
  ContactModel law_;
  SessionTally tally_;
};

}  // namespace palpate::launcher
