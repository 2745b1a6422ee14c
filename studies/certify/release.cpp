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

using Word = std::int64_t (*)(const Heard&);

/// What falls silent: how, by whose last word it counts, and how it is put right.
struct Silence {
  const char* who;
  void (*begin)(Processes&);
  void (*end)(Processes&);
  Word last_word;
  bool guarded = false;  ///< by the driver alone
};

std::int64_t last_law(const Heard& heard) { return heard.last_law_ns; }

const Silence kAll[] = {
    {"driver killed", [](Processes& p) { p.drive(false); }, [](Processes& p) { p.drive(true); },
     [](const Heard& heard) { return heard.last_driven_ns; }},
    {"deformation killed", [](Processes& p) { p.kill("deformation"); },
     [](Processes& p) { p.start_again("deformation"); }, last_law},
    {"collision killed", [](Processes& p) { p.kill("collision"); },
     [](Processes& p) { p.start_again("collision"); },
     [](const Heard& heard) { return heard.last_contacts_ns; }},
    {"haptics killed", [](Processes& p) { p.kill("haptics"); },
     [](Processes& p) { p.start_again("haptics"); },
     [](const Heard& heard) { return heard.force.header.source_time_ns; }, true},
    // A deformation that does not advance gives no law.
    {"paused", [](Processes& p) { p.command(SessionCommand::kPause); },
     [](Processes& p) { p.command(SessionCommand::kStart); }, last_law},
    {"at fault", [](Processes& p) { p.tell_scene("another"); },
     [](Processes& p) { p.tell_scene(""); }, last_law},
    {"reset", [](Processes& p) { p.command(SessionCommand::kReset); },
     [](Processes& p) { p.command(SessionCommand::kStart); }, last_law},
};

/// It presses, and still does so a while later.
bool presses(Processes& processes, double pressed, double longest) {
  const auto feels = [&](const Heard& heard) { return heard.force.force.norm() > pressed; };
  const bool force = processes.wait(feels, longest);
  processes.wait([](const Heard&) { return false; }, kCalm);
  return force && processes.wait(feels, kCalm);
}

/// Nobody has been pushed for a while; of a dead haptics nothing is heard, and the driver is asked.
bool is_let_go(const Silence& silence, const Heard& heard) {
  const std::int64_t still_ns = silence.guarded
                                    ? heard.last_driven_ns - heard.last_motor_ns
                                    : heard.force.header.source_time_ns - heard.last_pushed_ns;
  return still_ns > ns_from_seconds(kStill);
}

Release release(Processes& processes, const Silence& silence, double pressed) {
  Release found{silence.who};
  found.came = presses(processes, pressed, kTouchWithin);
  processes.heard().largest_step = 0;
  silence.begin(processes);
  const auto let_go = [&](const Heard& heard) { return is_let_go(silence, heard); };
  found.came &= processes.wait(let_go, kReleased);
  const Heard& heard = processes.heard();
  const std::int64_t last_ns = silence.guarded ? heard.last_motor_ns : heard.last_pushed_ns;
  found.took = seconds_from_ns(last_ns - silence.last_word(heard));
  silence.end(processes);
  found.back = presses(processes, pressed, kTouchWithin);
  found.step = heard.largest_step;
  return found;
}

}  // namespace

std::vector<Release> measure_releases(Processes& processes, double pressed, int times,
                                      const std::function<void(const Release&)>& told) {
  std::vector<Release> found;
  for (const Silence& silence : kAll) {
    for (int i = 0; i < times; ++i) {
      found.push_back(release(processes, silence, pressed));
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
  for (const Silence& silence : kAll) {
    const std::string name = std::string(silence.who) + ", ";
    double took = 0, step = 0;
    int count = 0, back = 0;
    for (const Release& r : releases) {
      if (r.who != silence.who) continue;
      ++count;
      back += r.back;
      took = std::max(took, r.came ? r.took : HUGE_VAL);
      step = std::max(step, r.step);
    }
    if (count == 0) continue;
    const std::string note = fmt::format("{} times", count);
    const double let_go =
        silence.guarded ? launcher::EmulatedDriver::kForceHolds + kOnTheWay : limit;
    lines.push_back(at_most(group, {name + "force zero after", 1e3 * took, 1e3 * let_go, "ms",
                                    silence.guarded ? "0.1 s, the driver's own guard, + 10 ms"
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
