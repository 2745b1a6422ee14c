#include "palpate/session_text.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <utility>

#include "modules/core/text.h"
#include "palpate/session/contact_line.h"

namespace palpate::launcher {
namespace {

std::string organ_lines(const SessionTally& tally) {
  std::string text;
  for (const auto& organ : tally.organs()) {
    text += fmt::format("organ {:<14} |V-V*|/V* at most {:.2e}   pressure {:.1f} to {:.1f} Pa",
                        organ.name, organ.worst_volume_error, organ.lowest_pressure,
                        organ.highest_pressure);
    if (organ.most_contacts > 0) {
      text += fmt::format("   contacts with organs at most {}", organ.most_contacts);
    }
    text += '\n';
  }
  return text;
}

/// " (too large by about 12 %: the mesh)".
std::string mesh_part(double force_error) {
  if (force_error <= 0) return "";
  if (force_error >= 1) return " (twice too large, or more: the mesh)";
  return fmt::format(" (too large by about {:.0f} %: the mesh)", 100 * force_error);
}

std::string probe_lines(const SessionTally& tally) {
  std::string text;
  for (const auto& probe : tally.probes()) {
    // What a limit made of the force is not the mesh's.
    const bool saturated = (probe.limits & kForceSaturated) != 0;
    text +=
        fmt::format("probe {:<14} force at most {:.3f} N{}   limits that acted: {}\n", probe.name,
                    probe.greatest_force, saturated ? "" : mesh_part(probe.error_of_greatest),
                    limit_names(probe.limits));
  }
  return text;
}

/// ", 99.950 % on time (of 1000 Hz) …"
std::string timing(const ModuleTally& module) {
  const ModuleStatus& status = module.newest;
  return fmt::format(
      ", {:.3f} % on time (of {:.0f} Hz{}), worst lateness {:.2f} ms since its start, busy "
      "{:.0f} %",
      100 * module.on_time_fraction(), status.nominal_rate_hz,
      status.realtime_priority ? ", real-time priority" : "", 1e3 * status.worst_lateness,
      100 * status.busy_fraction);
}

/// Samples that newer ones overtook are none of these: whoever wants the newest leaves the others.
std::string refusals(const ModuleTally& module) {
  std::uint64_t rejected = 0;
  for (const auto& input : module.newest.inputs) rejected += input.rejected;
  std::string text;
  if (rejected > 0) text += fmt::format("             {} samples refused\n", rejected);
  if (module.newest.packets_refused > 0) {
    text += fmt::format("             {} packets from a stranger refused\n",
                        module.newest.packets_refused);
  }
  return text;
}

std::string module_lines(const SessionTally& tally, bool lockstep) {
  std::string text;
  for (const auto& [name, module] : tally.modules()) {
    text +=
        fmt::format("{:<12} {} cycles{}\n", name, module.cycles(), lockstep ? "" : timing(module)) +
        refusals(module);
  }
  return text;
}

}  // namespace

std::string limit_names(std::uint32_t limits) {
  constexpr std::array<std::pair<ForceLimit, const char*>, 10> kNames{
      {{kForceSaturated, "saturated"},
       {kForceSlewLimited, "slew"},
       {kForceStaleFade, "stale"},
       {kForcePassivity, "passivity"},
       {kForceNotFinite, "not finite"},
       {kForceOutOfValidity, "out of validity"},
       {kPoseSlewed, "pose slewed"},
       {kPoseRefused, "pose refused"},
       {kDriverSilent, "driver silent"},
       {kStiffnessCapped, "stiffness capped"}}};
  std::string text;
  for (const auto& [bit, name] : kNames) {
    if ((limits & bit) != 0) text += (text.empty() ? "" : ", ") + std::string(name);
  }
  return text.empty() ? "none" : text;
}

std::string status_line(const SessionTally& tally, double time,
                        const std::vector<std::string>& away) {
  const auto is_away = [&](std::string_view module) {
    return std::ranges::find(away, module) != away.end();
  };
  std::string line = fmt::format("{:7.1f} s  real time {:.2f}", time, tally.real_time_factor());
  for (const auto& organ : tally.organs()) {
    line += fmt::format("  V/V* {} {:.6f}", organ.name, organ.volume_ratio);
  }
  for (const auto& probe : tally.probes()) {
    line += is_away("haptics") ? fmt::format("  force {} ?", probe.name)
                               : fmt::format("  force {} {:.3f} N", probe.name, probe.force);
  }
  for (const auto& [name, module] : tally.modules()) {
    if (is_away(name)) {
      line += fmt::format("  {} away", name);
      continue;
    }
    line += fmt::format("  {} {:.0f} Hz", name, module.newest.rate_hz);
    if (module.overruns() > 0) line += fmt::format(" ({} missed)", module.overruns());
    if (!module.newest.last_error.empty())
      line += fmt::format(" [{}]", printable(module.newest.last_error));
  }
  return line;
}

std::string waiting_line(const std::vector<std::string>& names, bool secured,
                         const bus::Refusals& refused) {
  std::string line = fmt::format("waiting for {}", fmt::join(names, ", "));
  if (secured) line += "; only who has keys of the same folder is heard";
  if (refused.count > 0) {
    line += fmt::format("; {} packets refused, the last: {}", refused.count, refused.last);
  }
  return line;
}

std::string summary(const SessionTally& tally, const SessionEnd& end) {
  // A session that was paused takes longer on the wall: what counts is the session's own clock.
  const double simulated =
      end.lockstep ? end.session_time : tally.real_time_factor() * end.session_time;
  const double taken = end.lockstep ? end.wall_time : end.session_time;
  std::string text =
      fmt::format("scene {}: {:.1f} s simulated in {:.1f} s, real-time factor {:.3f}\n", end.scene,
                  simulated, taken, taken > 0 ? simulated / taken : 0);
  text += organ_lines(tally) + probe_lines(tally) +
          session::contact_line(tally.contact_troubles()) + '\n' +
          module_lines(tally, end.lockstep);
  for (const auto& trouble : tally.troubles()) {
    text += fmt::format("degraded for a while: {}\n", trouble);
  }
  for (const auto& [module, times] : end.restarts) {
    text += fmt::format("started again: {}, {}\n", module,
                        times == 1 ? "once" : fmt::format("{} times", times));
  }
  if (!end.recording.empty()) text += fmt::format("recording: {}\n", end.recording);
  for (const auto& [module, failure] : end.failures) {
    text += fmt::format("FAILED: {}: {}\n", module, failure);
    const auto words = end.last_words.find(module);
    if (words != end.last_words.end() && !words->second.empty()) {
      text += fmt::format("  it said at last: {}\n", words->second);
    }
  }
  return text;
}

}  // namespace palpate::launcher
