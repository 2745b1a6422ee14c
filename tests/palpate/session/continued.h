// A session that goes on from a snapshot beside one that was never interrupted.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "modules/bus/tap.h"
#include "modules/runtime/wiring.h"
#include "palpate/session/in_process.h"
#include "tests/scratch_folder.h"

namespace palpate::session::testing {

/// All that is said on the session's topics: topic, and the bytes.
using Said = std::vector<std::pair<std::string, std::vector<std::uint8_t>>>;

/// What begins before `from` [s] is left out.
inline InProcessOptions listening(Said& said, double from) {
  InProcessOptions options;
  options.tap = [&said, from](bus::Bus& bus) -> std::unique_ptr<bus::Bus> {
    auto tapped = std::make_unique<bus::TappedBus>(bus);
    for (const runtime::Wire& wire : runtime::session_wires()) {
      tapped->set_tap(wire.topic, bus::record_tap([&said, from](const bus::Passing& passing) {
                        if (passing.now_ns < ns_from_seconds(from)) return;
                        said.emplace_back(passing.topic.name, std::vector(passing.payload.begin(),
                                                                          passing.payload.end()));
                      }));
    }
    return tapped;
  };
  return options;
}

struct Continued {
  Said whole, rest;  ///< from the snapshot on
  double force = 0;  ///< largest then [N]: something is touched
};

/// The same, written and read; of a scene that is no file, as it is.
inline runtime::Snapshot from_file(const runtime::Snapshot& snapshot, const scene::Scene& scene) {
  if (scene.file.empty()) return snapshot;
  const ScratchFolder folder;
  runtime::write_snapshot(folder / "at.snapshot", scene, snapshot);
  return runtime::read_snapshot(folder / "at.snapshot", scene);
}

/// Runs a scene to `end`, with snapshots at some times, and another session from each
/// [s].
inline std::vector<Continued> continued(const scene::Scene& scene, const Assets& assets,
                                        const std::vector<double>& times, double end) {
  Said said;
  std::vector<Continued> all;
  std::vector<std::size_t> before;
  std::vector<runtime::Snapshot> taken;
  InProcess session(scene, assets, listening(said, times.front()));
  for (const double at : times) {
    session.run_until(at);
    taken.push_back(session.snapshot());
    all.emplace_back();
    before.push_back(said.size());
  }
  double force = 0;
  for (; session.time() < end; session.tick()) {
    for (std::size_t probe = 0; probe < scene.probes.size(); ++probe) {
      force = std::max(force, session.contact_model(probe).force().norm());
    }
  }
  for (std::size_t k = 0; k < times.size(); ++k) {
    all[k].force = force;
    all[k].whole.assign(said.begin() + static_cast<std::ptrdiff_t>(before[k]), said.end());
    const runtime::Snapshot from = from_file(taken[k], scene);
    InProcessOptions options = listening(all[k].rest, times[k]);
    options.from = &from;
    InProcess rest(scene, assets, options);
    rest.run_until(end);
  }
  return all;
}

inline Continued continued(const scene::Scene& scene, const Assets& assets, double at, double end) {
  return continued(scene, assets, std::vector{at}, end).front();
}

/// Where they differ first; empty: nowhere.
inline std::string first_difference(const Continued& both) {
  for (std::size_t i = 0; i < std::min(both.whole.size(), both.rest.size()); ++i) {
    if (both.whole[i] == both.rest[i]) continue;
    return "sample " + std::to_string(i) + ", " + both.whole[i].first;
  }
  if (both.whole.size() == both.rest.size()) return "";
  return std::to_string(both.whole.size()) + " samples and " + std::to_string(both.rest.size());
}

}  // namespace palpate::session::testing
