#include "studies/certify/release.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "modules/core/units.h"

namespace palpate::certify {
namespace {

constexpr double kOnTheWay = 0.010;  // the last sample's way and a late tick [s]
constexpr double kTouchWithin = 20, kReleased = 5, kCalm = 1;  // [s]
constexpr double kStill = 0.2;                                 // a force may pass through zero [s]
const std::string kDriver = "driver", kHaptics = "haptics";
const std::string kAll[] = {kDriver, "deformation", "collision", kHaptics};

/// It presses, and still does so a while later.
bool presses(Processes& processes, double pressed, double longest) {
  const auto feels = [&](const Heard& heard) { return heard.force.force.norm() > pressed; };
  const bool force = processes.wait(feels, longest);
  processes.wait([](const Heard&) { return false; }, kCalm);
  return force && processes.wait(feels, kCalm);
}

std::int64_t last_word_ns(const std::string& who, const Heard& heard) {
  if (who == kDriver) return heard.last_driven_ns;
  if (who == kHaptics) return heard.force.header.source_time_ns;
  return who == "deformation" ? heard.last_law_ns : heard.last_contacts_ns;
}

/// Nobody has been pushed for a while; of a dead haptics nothing is heard, and the driver is asked.
bool is_let_go(const std::string& who, const Heard& heard) {
  const std::int64_t still_ns = who == kHaptics
                                    ? heard.last_driven_ns - heard.last_motor_ns
                                    : heard.force.header.source_time_ns - heard.last_pushed_ns;
  return still_ns > ns_from_seconds(kStill);
}

Release release(Processes& processes, const std::string& who, double pressed) {
  Release found{who};
  found.came = presses(processes, pressed, kTouchWithin);
  processes.heard().largest_step = 0;
  if (who == kDriver) {
    processes.drive(false);
  } else {
    processes.kill(who);
  }
  const auto let_go = [&](const Heard& heard) { return is_let_go(who, heard); };
  found.came &= processes.wait(let_go, kReleased);
  const Heard& heard = processes.heard();
  const std::int64_t last_ns = who == kHaptics ? heard.last_motor_ns : heard.last_pushed_ns;
  found.took = seconds_from_ns(last_ns - last_word_ns(who, heard));
  if (who == kDriver) {
    processes.drive(true);
  } else {
    processes.start_again(who);
  }
  found.back = presses(processes, pressed, kTouchWithin);
  found.step = heard.largest_step;
  return found;
}

}  // namespace

std::vector<Release> measure_releases(Processes& processes, double pressed, int times,
                                      const std::function<void(const Release&)>& told) {
  std::vector<Release> found;
  for (const auto& who : kAll) {
    for (int i = 0; i < times; ++i) {
      found.push_back(release(processes, who, pressed));
      told(found.back());
    }
  }
  return found;
}

std::vector<Line> release_lines(const std::vector<Release>& releases, const scene::Scene& scene) {
  const std::string group = "released";
  const double limit = scene.haptics.stale_after + scene.haptics.fade_time + kOnTheWay;
  const double slew = scene.haptics.max_force_rate / scene.rates.haptics * (1 + 1e-9);
  std::vector<Line> lines;
  for (const auto& who : kAll) {
    const std::string name = who + " killed, ";
    double took = 0, step = 0;
    int count = 0, back = 0;
    for (const Release& r : releases) {
      if (r.who != who) continue;
      ++count;
      back += r.back;
      took = std::max(took, r.came ? r.took : HUGE_VAL);
      step = std::max(step, r.step);
    }
    if (count == 0) continue;
    const std::string note = fmt::format("{} times", count);
    const bool guarded = who == kHaptics;
    const double let_go = guarded ? launcher::EmulatedDriver::kForceHolds + kOnTheWay : limit;
    lines.push_back(at_most(group, {name + "force zero after", 1e3 * took, 1e3 * let_go, "ms",
                                    guarded ? "0.1 s, the driver's own guard, + 10 ms"
                                            : "stale_after_s + fade_time_s + 10 ms",
                                    note}));
    lines.push_back(at_most(group, {name + "largest step until it is back", step, slew, "N",
                                    "max_force_rate_n_per_s", note}));
    lines.push_back(at_least(group, {name + "presses again within 20 s", 100.0 * back / count, 100,
                                     "%", "docs/certify.md", note}));
  }
  return lines;
}

}  // namespace palpate::certify
