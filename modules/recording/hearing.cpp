#include "modules/recording/hearing.h"

#include <algorithm>

#include "modules/runtime/wiring.h"

namespace palpate::recording {

Hearing::Hearing(bus::Bus& bus, std::vector<std::string> modules)
    : statuses_(bus.reader(bus::kModuleStatus)),
      modules_(std::move(modules)),
      not_ready_(modules_.begin(), modules_.end()) {}

bool Hearing::complete(const SessionReader& reader) {
  while (statuses_.take(status_)) {
    if (status_.state != ModuleState::kStarting) not_ready_.erase(status_.module);
  }
  complete_ = complete_ || (not_ready_.empty() && met_all(reader));
  return complete_;
}

bool Hearing::met_all(const SessionReader& reader) const {
  const auto met = [&](std::string_view topic, std::ptrdiff_t writers) {
    const auto count = reader.matched_writers(topic);
    return !count || *count >= writers;
  };
  for (const runtime::Wire& wire : runtime::session_wires()) {
    const auto writes = [&](const std::string& module) {
      return runtime::module_named(module)->job == wire.writer;
    };
    if (!met(wire.topic, std::ranges::count_if(modules_, writes))) return false;
  }
  return met(bus::kModuleStatus.name, std::ssize(modules_)) && met(bus::kScene.name, 1) &&
         met(bus::kSessionControl.name, 1);
}

}  // namespace palpate::recording
