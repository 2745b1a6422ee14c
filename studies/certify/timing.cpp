#include "studies/certify/timing.h"

#include <spdlog/fmt/fmt.h>

#include "modules/runtime/stolen_time.h"
#include "studies/report/measures.h"

namespace palpate::certify {
namespace {

constexpr double kOnTime = 99.95;      // [%]
constexpr double kLatency = 1.5;       // [ms]
constexpr double kCarried = 10;        // [ms]
constexpr std::size_t kFewest = 1000;  // samples that a 99.9 % takes

std::vector<Line> quantile_lines(const std::string& group, const std::string& what,
                                 const std::vector<double>& values,
                                 const std::vector<Measured>& limits) {
  constexpr double kParts[] = {0.5, 0.99, 0.999, 1};
  constexpr const char* kNames[] = {"p50", "p99", "p99.9", "max"};
  std::vector<Line> lines;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const std::string name = what + ", " + kNames[i];
    if (values.size() < kFewest) {
      lines.push_back(not_measured(group, name, fmt::format("{} samples", values.size())));
      continue;
    }
    Measured line = limits[i];
    line.name = name;
    line.value = 1e3 * report::quantile(values, kParts[i]);
    line.unit = "ms";
    line.note = fmt::format("of {} samples", values.size());
    lines.push_back(at_most(group, line));
  }
  return lines;
}

}  // namespace

Timing measure_timing(Processes& processes, double seconds) {
  Heard& heard = processes.heard();
  const ModuleStatus before = heard.modules["haptics"];
  heard.periods.clear();
  heard.latencies.clear();
  const runtime::CoreTicks ticks = runtime::core_ticks();
  heard.timing = true;
  processes.wait([](const Heard&) { return false; }, seconds);
  heard.timing = false;
  const ModuleStatus &after = heard.modules["haptics"], &tissue = heard.modules["deformation"];
  return {heard.periods,
          heard.latencies,
          after.cycles - before.cycles,
          after.overruns - before.overruns,
          after.realtime_priority,
          tissue.real_time_factor,
          runtime::stolen_share(ticks, runtime::core_ticks())};
}

std::vector<Line> timing_lines(const std::string& group, const Timing& timing, double period) {
  const double T = 1e3 * period;
  const auto limit = [](double value, const char* source) {
    return Measured{"", 0, value, "", source, ""};
  };
  auto lines = quantile_lines(group, "loop period", timing.periods,
                              {limit(1.01 * T, "T and 1 %"), limit(1.5 * T, "T and a half"),
                               limit(2 * T, "2 T: a tick was missed"),
                               limit(kCarried, "a pose is carried for at most 10 ms")});
  const auto passed = static_cast<double>(timing.cycles + timing.overruns);
  const std::string name = "ticks on time";
  lines.push_back(
      passed < kFewest
          ? not_measured(group, name, "no status of haptics")
          : at_least(group, {name, 100 * static_cast<double>(timing.cycles) / passed, kOnTime, "%",
                             "docs/certify.md",
                             fmt::format("{} of {:.0f} missed; SCHED_FIFO {}; real-time factor of "
                                         "deformation {:.2f}; the host took {:.1f} % of the cores",
                                         timing.overruns, passed,
                                         timing.realtime ? "granted" : "not granted", timing.factor,
                                         100 * timing.stolen)}));
  const auto latencies = quantile_lines(
      group, "pose to force", timing.latencies,
      {limit(kLatency, "docs/certify.md"), limit(kLatency, "docs/certify.md"),
       limit(kLatency, "docs/certify.md"), limit(kCarried, "a pose is carried for at most 10 ms")});
  lines.insert(lines.end(), latencies.begin(), latencies.end());
  return lines;
}

}  // namespace palpate::certify
