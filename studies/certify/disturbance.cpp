#include "studies/certify/disturbance.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <deque>
#include <random>

#include "modules/bus/tap.h"
#include "modules/core/units.h"
#include "studies/certify/press.h"
#include "studies/certify/stability.h"

namespace palpate::certify {
namespace {

/// Uniform in [0, 1), the same on every machine.
double uniform(std::mt19937_64& random) { return 0x1p-53 * static_cast<double>(random() >> 11); }

bus::Tap late_tap(const Disturbance& disturbance, std::uint64_t seed) {
  struct Waiting {
    std::int64_t due_ns;
    std::vector<std::uint8_t> bytes;
  };
  return [disturbance, random = std::mt19937_64(seed), waiting = std::deque<Waiting>()](
             const bus::Passing& passing, const bus::Forward& forward) mutable {
    std::int64_t due_ns =
        passing.now_ns + ns_from_seconds(disturbance.delay + disturbance.jitter * uniform(random));
    if (!waiting.empty()) due_ns = std::max(due_ns, waiting.back().due_ns);
    waiting.push_back({due_ns, {passing.payload.begin(), passing.payload.end()}});
    for (; !waiting.empty() && waiting.front().due_ns <= passing.now_ns; waiting.pop_front()) {
      forward(waiting.front().bytes);
    }
  };
}

bus::Tap losing_tap(double share, std::uint64_t seed) {
  return bus::lose_tap([share, random = std::mt19937_64(seed)](const bus::Passing&) mutable {
    return uniform(random) < share;
  });
}

}  // namespace

std::string Disturbance::name() const {
  std::vector<std::string> parts;
  if (delay > 0) parts.push_back(fmt::format("{:g} ms late", 1e3 * delay));
  if (jitter > 0) parts.push_back(fmt::format("up to {:g} ms more", 1e3 * jitter));
  if (loss > 0) parts.push_back(fmt::format("{:g} % lost", 100 * loss));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::vector<Disturbance> disturbances(bool quick) {
  if (quick) return {{0.02, 0, 0}, {0.01, 0.01, 0.2}};
  return {{0.01, 0, 0}, {0.02, 0, 0}, {0.05, 0, 0},      {0, 0.02, 0},
          {0, 0, 0.05}, {0, 0, 0.2},  {0.01, 0.01, 0.2}, {0.05, 0.02, 0.2}};
}

Loop disturbed(Loop loop, const Disturbance& disturbance) {
  loop.options.tap = [disturbance](bus::Bus& carrier) {
    auto tapped = std::make_unique<bus::TappedBus>(carrier);
    std::uint64_t seed = 1;
    for (const auto topic : {bus::kContactModel.name, bus::kNodePositions.name}) {
      if (disturbance.loss > 0) tapped->set_tap(topic, losing_tap(disturbance.loss, ++seed));
      if (disturbance.delay + disturbance.jitter > 0) {
        tapped->set_tap(topic, late_tap(disturbance, ++seed));
      }
    }
    return tapped;
  };
  return loop;
}

std::vector<Line> disturbance_lines(const Subject& subject, const Disturbance& disturbance,
                                    double push, const KeepGoing& keep_going,
                                    ContactTroubles& troubles) {
  const std::string group = "link: " + disturbance.name();
  const Loop loop = disturbed(loop_on_organ(subject, &troubles), disturbance);
  const auto press = press_and_release(loop, subject, keep_going);
  const auto held = hold(loop, subject, push, keep_going);
  std::vector<Line> lines{first_contact_line(group, "step of first contact", press),
                          largest_step_line(group, "largest step of a press", press),
                          energy_line(group, "energy of a press and release", press, subject)};
  for (Line& line : held_lines(group, held)) lines.push_back(std::move(line));
  return lines;
}

}  // namespace palpate::certify
