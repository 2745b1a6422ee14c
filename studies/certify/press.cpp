#include "studies/certify/press.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "studies/certify/hands.h"

namespace palpate::certify {
namespace {

constexpr double kRest = 0.3;           // deep, and after [s]
constexpr double kFirstContact = 0.02;  // [s]

}  // namespace

std::vector<Tick> press_and_release(const Loop& loop, const Subject& subject,
                                    const KeepGoing& keep_going) {
  const double move = (kAbove + subject.depth) / subject.speed;
  const auto hand = firm_hand(subject.device, loop.place,
                              {{pose_below(loop.place, subject.depth).position, move},
                               {std::nullopt, kRest},
                               {pose_below(loop.place, -kAbove).position, move}});
  return run_loop(loop, hand, 2 * (move + kRest), keep_going);
}

Line first_contact_line(const std::string& group, const std::string& name,
                        const std::vector<Tick>& ticks) {
  const Tick* first = first_force(ticks);
  if (first == nullptr) return not_measured(group, name, "there was no force");
  const Tick& worst = largest_step(ticks, first->time, first->time + kFirstContact);
  return at_most(group,
                 {name, worst.step, kFeltStep, "N", "what a hand feels as a step, docs/certify.md",
                  fmt::format("{:.1f} mm deep", 1e3 * worst.depth)});
}

Line largest_step_line(const std::string& group, const std::string& name,
                       const std::vector<Tick>& ticks) {
  if (first_force(ticks) == nullptr) return not_measured(group, name, "there was no force");
  const auto felt = [](const Tick& tick) {
    return std::max(kFeltStep, kFeltShare * std::abs(tick.force));
  };
  const auto worst = std::max_element(
      ticks.begin(), ticks.end(),
      [&](const Tick& a, const Tick& b) { return a.step / felt(a) < b.step / felt(b); });
  return at_most(
      group, {name, worst->step, felt(*worst), "N", "5 % of the force or 0.05 N, docs/certify.md",
              fmt::format("at {:.3f} s, {:.1f} mm deep", worst->time, 1e3 * worst->depth)});
}

Line energy_line(const std::string& group, const std::string& name, const std::vector<Tick>& ticks,
                 const Subject& subject) {
  if (first_force(ticks) == nullptr) return not_measured(group, name, "there was no force");
  const double period = 1 / subject.scene.rates.haptics;
  double force = 0, speed = 0, stored = 0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    if (ticks[i].motor <= 0) continue;
    force = std::max(force, ticks[i].motor);
    speed = std::max(speed, std::abs(ticks[i].depth - ticks[i - 1].depth) / period);
    stored = std::max(stored, -ticks[i].work);
  }
  const bool out = ticks.back().motor == 0 && ticks.back().depth < 0;
  const double limit = force * speed * (period + 2 * delay_of(subject.device));
  return at_most(group, {name, out ? 1e3 * ticks.back().work : HUGE_VAL, 1e3 * limit, "mJ",
                         "K v D (T + 2 t_d), docs/haptic_safety.md",
                         fmt::format("of {:.3g} mJ put in; {:.3g} N, {:.3g} m/s", 1e3 * stored,
                                     force, speed)});
}

}  // namespace palpate::certify
