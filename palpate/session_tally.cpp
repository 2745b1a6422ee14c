#include "palpate/session_tally.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "modules/core/text.h"
#include "modules/runtime/wiring.h"

namespace palpate::launcher {
namespace {

/// Without the count that a guard's text ends in from its second time on: " (3 times)".
std::string_view without_count(std::string_view text) {
  return text.ends_with(" times)") ? text.substr(0, text.rfind(" (")) : text;
}

}  // namespace

double ModuleTally::on_time_fraction() const {
  const auto periods = static_cast<double>(cycles() + overruns());
  return periods > 0 ? static_cast<double>(cycles()) / periods : 1;
}

SessionTally::SessionTally(const scene::Scene& scene) {
  for (const auto& organ : scene.organs) organs_.push_back({{}, organ.name});
  for (const auto& probe : scene.probes) probes_.push_back({{}, probe.name});
}

void SessionTally::start() {
  started_ = true;
  for (auto& [name, module] : modules_) {
    module.cycles_before = module.newest.cycles;
    module.overruns_before = module.newest.overruns;
  }
}

void SessionTally::receive(const ModuleStatus& status, const bus::WriterId& writer) {
  ModuleTally& module = modules_[status.module];
  const bool another = module.newest.process_id != status.process_id;  // started again
  // Counts of one process never go back: sums since the start would wrap.
  if (another || status.cycles < module.newest.cycles || status.overruns < module.newest.overruns) {
    module = {};
  }
  module.newest = status;
  of_processes_[{status.module, status.process_id, writer}] = status.contacts;
  receive(status.organs);
  receive(status.probes);
  if (!started_ || standing_) return;
  if (status.state == ModuleState::kDegraded) note_degraded(status.module, status.last_error);
}

void SessionTally::note_degraded(const std::string& module, const std::string& said) {
  if (said.empty()) return;
  const std::string text = module + ": " + printable(said);
  const auto same = std::find_if(troubles_.begin(), troubles_.end(), [&](const auto& known) {
    return without_count(known) == without_count(text);
  });
  if (same == troubles_.end()) {
    troubles_.push_back(text);
  } else {
    *same = text;
  }
}

void SessionTally::receive(std::span<const OrganExtremes> organs) {
  for (const OrganExtremes& said : organs) {
    if (said.organ >= organs_.size()) continue;
    OrganTally& organ = organs_[said.organ];
    organ.volume_ratio = said.volume_ratio;
    organ.worst_volume_error = std::max(organ.worst_volume_error, said.worst_volume_error);
    organ.lowest_pressure = std::min(organ.lowest_pressure, said.lowest_pressure);
    organ.highest_pressure = std::max(organ.highest_pressure, said.highest_pressure);
    organ.most_contacts = std::max(organ.most_contacts, said.most_contacts);
  }
}

void SessionTally::receive(std::span<const ProbeExtremes> probes) {
  for (const ProbeExtremes& said : probes) {
    if (said.probe >= probes_.size()) continue;
    ProbeTally& probe = probes_[said.probe];
    probe.force = said.force;
    probe.limits |= said.limits;
    if (said.greatest_force <= probe.greatest_force) continue;
    probe.greatest_force = said.greatest_force;
    probe.error_of_greatest = said.error_of_greatest;
  }
}

ContactTroubles SessionTally::contact_troubles() const {
  ContactTroubles sum = of_session_;
  for (const auto& [process, contacts] : of_processes_) sum += contacts;
  return sum;
}

const ModuleTally* SessionTally::module(const std::string& name) const {
  const auto found = modules_.find(name);
  return found == modules_.end() ? nullptr : &found->second;
}

double SessionTally::real_time_factor() const {
  std::optional<double> least;
  for (const auto& [name, module] : modules_) {
    const auto named = runtime::module_named(name);
    if (!named || named->job != "deformation") continue;
    least =
        std::min(least.value_or(module.newest.real_time_factor), module.newest.real_time_factor);
  }
  return least.value_or(0);
}

}  // namespace palpate::launcher
