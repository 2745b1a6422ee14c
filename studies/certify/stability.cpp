#include "studies/certify/stability.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "studies/certify/hands.h"

namespace palpate::certify {
namespace {

constexpr double kShare = 0.8;                    // of the formula, that a loop must reach
constexpr double kSoftest = 0.05, kStiffest = 4;  // of the formula
constexpr double kStride = 1.25, kResolution = 1.02;
constexpr double kWallPush = 0.5, kWallDepth = 0.01;  // at most, on walls [N], [m]
constexpr double kStiffWall = 10;                     // of the formula: needs the virtual coupling
constexpr double kSettled = 1e-6;                     // no device resolves it [m]
constexpr double kDecay = 0.98;  // in five seconds: what is bounded stays as large
constexpr double kEarly = 2, kLate = 7, kWindow = 1;  // [s]
constexpr double kAtRest = 2, kLast = 4, kHeld = 5;   // [s]
constexpr double kSwing = 1e-4;                       // [m]

/// A device pushed against a wall, its encoders exact.
std::vector<Tick> push_on_wall(const Subject& subject, double stiffness,
                               const KeepGoing& keep_going) {
  const Loop wall = loop_on_wall(subject.scene, stiffness);
  const double push = std::min(kWallPush, kWallDepth * stiffness);
  auto device = pushing_hand(subject.device, wall.place, push);
  device.encoder_step = 0;
  return run_loop(wall, device, kLate + kWindow, keep_going);
}

bool comes_to_rest(const Subject& subject, double stiffness, const KeepGoing& keep_going) {
  const auto ticks = push_on_wall(subject, stiffness, keep_going);
  const double late = swing(ticks, kLate, kLate + kWindow);
  return late < kSettled || late < kDecay * swing(ticks, kEarly, kEarly + kWindow);
}

}  // namespace

double formula_stiffness(const Subject& subject) {
  return subject.scene.haptics.device_damping /
         (0.5 / subject.scene.rates.haptics + delay_of(subject.device));
}

std::optional<double> critical_stiffness(const Subject& subject, const KeepGoing& keep_going) {
  const double formula = formula_stiffness(subject);
  double low = kSoftest * formula, high = low;
  if (!comes_to_rest(subject, low, keep_going)) return std::nullopt;
  // From below: far beyond the border a bounded vibration may calm down by chance.
  while (comes_to_rest(subject, high, keep_going)) {
    low = high;
    if (high >= kStiffest * formula) return high;
    high *= kStride;
  }
  while (high > kResolution * low) {
    const double middle = std::sqrt(low * high);
    (comes_to_rest(subject, middle, keep_going) ? low : high) = middle;
  }
  return low;
}

Line critical_line(const Subject& subject, const KeepGoing& keep_going) {
  const double formula = formula_stiffness(subject), delay = delay_of(subject.device);
  const auto critical = critical_stiffness(subject, keep_going);
  std::string note = fmt::format("the formula gives {:.4g} N/m", formula);
  if (critical && *critical >= kStiffest * formula) note += "; none that was tried was too stiff";
  return at_least(
      "stability",
      {fmt::format("critical stiffness of a wall, t_d {:g} ms", 1e3 * delay), critical.value_or(0),
       kShare * formula, "N/m", "80 % of b/(T/2 + t_d), b of the scene", note});
}

Line stiff_wall_line(const Subject& subject, const KeepGoing& keep_going) {
  const double formula = formula_stiffness(subject);
  const auto ticks = push_on_wall(subject, kStiffWall * formula, keep_going);
  return at_most(
      "stability",
      {fmt::format("swing on a wall of {:g} times b/(T/2 + t_d), eighth second", kStiffWall),
       1e3 * swing(ticks, kLate, kLate + kWindow), 1e3 * 2 * kWallPush / formula, "mm",
       "undamped at b/(T/2 + t_d): twice the push over it",
       fmt::format("{:.4g} N/m, pushed by {:g} N", kStiffWall * formula, kWallPush)});
}

std::vector<Tick> hold(const Loop& loop, const Subject& subject, double push,
                       const KeepGoing& keep_going) {
  return run_loop(loop, pushing_hand(subject.device, loop.place, push), kHeld, keep_going);
}

namespace {

constexpr double kLeastHeld = 1e-3;  // what is weaker holds no device [N]

Line swing_after(const std::string& group, const std::string& name, const std::string& source,
                 double from, const std::vector<Tick>& ticks) {
  const double found = swing(ticks, from, kHeld);
  const std::string note =
      std::isfinite(found)
          ? fmt::format("{:.2f} mm deep", 1e3 * ticks.back().depth)
          : fmt::format("it left after {:.2f} s", ticks.empty() ? 0 : ticks.back().time);
  const Line line = at_most(group, {name, 1e3 * found, 1e3 * kSwing, "mm", source, note});
  const auto pushes = [&](const Tick& tick) {
    return tick.time >= from && std::abs(tick.motor) >= kLeastHeld;
  };
  if (line.verdict != Verdict::kPass || std::ranges::any_of(ticks, pushes)) return line;
  return not_measured(group, name,
                      fmt::format("nothing to judge, no force reaches {:g} N", kLeastHeld));
}

}  // namespace

std::vector<Line> held_lines(const std::string& group, const std::vector<Tick>& ticks) {
  return {swing_after(group, "swing of a held contact", "at rest within 2 s, docs/certify.md",
                      kAtRest, ticks),
          swing_after(group, "limit cycle of a held contact, swing in the fifth second",
                      "docs/certify.md", kLast, ticks)};
}

}  // namespace palpate::certify
