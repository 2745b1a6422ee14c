#include "modules/runtime/wiring.h"

#include <algorithm>
#include <charconv>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/runtime/stage.h"
#include "modules/scene/processes.h"

namespace palpate::runtime {
namespace {

using Keys = Wire::Keys;

constexpr std::array kWires{
    Wire{"scene", "", Keys::kOne, false, {}},
    Wire{"surface", "deformation", Keys::kOrgans, false, {"collision", "visualizer"}},
    Wire{"probe_state", "haptics", Keys::kProbes, true, {"collision", "deformation", "visualizer"}},
    Wire{"probe_input", "", Keys::kProbes, false, {"haptics"}},
    Wire{"contacts", "collision", Keys::kProbes, true, {"deformation", "visualizer"}},
    Wire{"node_positions", "deformation", Keys::kOrgans, true, {"collision", "visualizer"}},
    Wire{"contact_model", "deformation", Keys::kProbesOfProcesses, true, {"haptics", "visualizer"}},
    Wire{"haptic_force", "haptics", Keys::kProbes, true, {"visualizer"}},
};

std::string_view job_of(std::string_view module) {
  const auto named = module_named(module);
  PALPATE_DEMAND(named.has_value());
  return named->job;
}

std::size_t rank_of(std::string_view module) {
  const auto found = std::find(kModules.begin(), kModules.end(), job_of(module));
  PALPATE_DEMAND(found != kModules.end());
  return static_cast<std::size_t>(found - kModules.begin());
}

}  // namespace

std::optional<ModuleName> module_named(std::string_view name) {
  const auto is_job = [](std::string_view word) {
    return std::find(kModules.begin(), kModules.end(), word) != kModules.end();
  };
  if (is_job(name)) return ModuleName{name, 1};
  constexpr std::string_view kShared = "deformation_";
  if (!name.starts_with(kShared)) return std::nullopt;
  const std::string_view digits = name.substr(kShared.size());
  std::size_t process = 0;
  const auto [end, error] = std::from_chars(digits.begin(), digits.end(), process);
  if (error != std::errc() || end != digits.end() || digits.starts_with('0')) return std::nullopt;
  if (process < 2 || process > scene::kMaxProcesses) return std::nullopt;
  return ModuleName{name.substr(0, kShared.size() - 1), process};
}

std::string name_of(const ModuleName& module) {
  std::string name(module.job);
  return module.process == 1 ? name : name + "_" + std::to_string(module.process);
}

std::span<const Wire> session_wires() { return kWires; }

const Wire* find_wire(std::string_view topic) {
  const auto found = std::find_if(kWires.begin(), kWires.end(),
                                  [&](const Wire& wire) { return wire.topic == topic; });
  return found == kWires.end() ? nullptr : &*found;
}

CycleGrid::CycleGrid(double rate_hz) : period_ns_(ns_from_seconds(1 / rate_hz)) {
  PALPATE_DEMAND(period_ns_ > 0);
}

std::int64_t CycleGrid::last_at(std::int64_t time_ns) const {
  return time_ns < 0 ? kNever : time_ns / period_ns_ * period_ns_;
}

double rate_of(std::string_view name, const scene::Scene& scene) {
  const std::string_view module = job_of(name);
  if (module == "haptics") return scene.rates.haptics;
  if (module == "collision") return scene.rates.collision;
  if (module == "deformation") return scene.rates.deformation;
  if (module == "visualizer") return scene.rates.visualizer;
  PALPATE_DEMAND(module == "recorder");
  return kRecorderRate;
}

double input_stale_after(const scene::Scene& scene) {
  constexpr double kPeriods = 2;  // of the writers of probe states and contacts
  const double slowest = std::min(scene.rates.haptics, scene.rates.collision);
  return std::max({kInputStaleAfter, scene.haptics.stale_after, kPeriods / slowest});
}

InputRule::InputRule(const scene::Scene& scene, std::string_view module)
    : scene_(scene), rank_(rank_of(module)) {}

bool InputRule::writes_first(const Wire& wire) const {
  return wire.writer.empty() || rank_of(wire.writer) < rank_;
}

std::int64_t InputRule::horizon(std::string_view topic, std::int64_t time_ns) const {
  const Wire* wire = find_wire(topic);
  return wire == nullptr || writes_first(*wire) ? time_ns : time_ns - 1;
}

std::int64_t InputRule::required(std::string_view topic, std::int64_t time_ns) const {
  const Wire* wire = find_wire(topic);
  if (wire == nullptr || !wire->every_cycle) return CycleGrid::kSetUp;
  const CycleGrid grid(rate_of(wire->writer, scene_));
  return writes_first(*wire) ? grid.last_at(time_ns) : grid.last_before(time_ns);
}

std::size_t InputRule::keys(std::string_view topic) const {
  const Wire* wire = find_wire(topic);
  if (wire == nullptr || (wire->writer.empty() && wire->topic != "scene")) return 0;
  switch (wire->keys) {
    case Keys::kProbes:
      return scene_.probes.size();
    case Keys::kOrgans:
      return scene_.organs.size();
    case Keys::kProbesOfProcesses:
      return scene_.probes.size() * scene::process_count(scene_);
    case Keys::kOne:
      return 1;
  }
  return 0;
}

bool InputRule::comes_in_parts(std::string_view topic) {
  const Wire* wire = find_wire(topic);
  return wire != nullptr && wire->keys == Keys::kProbesOfProcesses;
}

bool is_awaited(std::string_view module, std::int64_t time_ns, const scene::Scene& scene,
                const std::vector<std::string>& participants) {
  const auto waits = [&](const Wire& wire, std::string_view reader) {
    const std::int64_t period_ns = CycleGrid(rate_of(reader, scene)).period_ns();
    const InputRule rule(scene, reader);
    // Of its cycles from then on the first that sees what was said then.
    std::int64_t cycle_ns = (time_ns + period_ns - 1) / period_ns * period_ns;
    if (rule.horizon(wire.topic, cycle_ns) < time_ns) cycle_ns += period_ns;
    return rule.required(wire.topic, cycle_ns) == time_ns;
  };
  for (const Wire& wire : kWires) {
    if (!wire.every_cycle || wire.writer != job_of(module)) continue;
    for (const std::string& name : participants) {
      const std::string_view reader = job_of(name);
      if (std::ranges::find(wire.readers, reader) != wire.readers.end() && waits(wire, reader)) {
        return true;
      }
    }
  }
  return false;
}

int reader_count(std::string_view topic, const std::vector<std::string>& participants) {
  const Wire* wire = find_wire(topic);
  if (wire == nullptr) return 0;
  return static_cast<int>(
      std::count_if(participants.begin(), participants.end(), [&](const std::string& name) {
        const std::string_view module = job_of(name);
        return module == "recorder" ||
               std::find(wire->readers.begin(), wire->readers.end(), module) != wire->readers.end();
      }));
}

}  // namespace palpate::runtime
