// A session over two made hosts, each with its own `palpate run --hosts`.
#pragma once

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "modules/core/units.h"
#include "modules/recording/sample_reader.h"
#include "tests/modules/runtime/own_bus.h"
#include "tests/network/made_network.h"
#include "tests/palpate/ball_scene.h"
#include "tests/system/launched.h"

namespace palpate::testing {

inline constexpr double kRunDeadline = 90;  ///< [s]; a run takes about ten

/// A press of 1.5 cm depth of fingertip, held.
inline const std::string kHeldPress =
    "scripted: {start_m: [0, 0, 0.065], moves: [{to_m: [0, 0, 0.05], duration_s: 1}]}";

/// What one host's haptics felt.
struct Felt {
  double first_s = 0;                  ///< session time of the first sample
  std::vector<double> at, force, age;  ///< session time [s], [N], of the law [s]
  std::vector<std::uint32_t> limits;
  std::map<std::string, double> worst_age_error;  ///< "haptics contact_model" → [s]
  std::vector<std::string> troubles;

  /// Of the samples in a stretch of session time.
  template <class F>
  void during(double begin, double end, const F& f) const {
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (at[i] >= begin && at[i] < end) f(i);
    }
  }
  double mean_force(double begin, double end) const {
    double sum = 0, count = 0;
    during(begin, end, [&](std::size_t i) { sum += force[i], ++count; });
    return count > 0 ? sum / count : -1;
  }
  double largest_force(double begin, double end) const {
    double most = 0;
    during(begin, end, [&](std::size_t i) { most = std::max(most, force[i]); });
    return most;
  }
  double median_age(double begin, double end) const {
    std::vector<double> ages;
    during(begin, end, [&](std::size_t i) { ages.push_back(age[i]); });
    if (ages.empty()) return -1;
    std::nth_element(ages.begin(), ages.begin() + std::ptrdiff_t(ages.size() / 2), ages.end());
    return ages[ages.size() / 2];
  }
  std::uint32_t limits_acted(double begin, double end) const {
    std::uint32_t all = 0;
    during(begin, end, [&](std::size_t i) { all |= limits[i]; });
    return all;
  }
};

inline Felt felt_of(const std::filesystem::path& recording) {
  Felt felt;
  recording::SampleReader reader(recording);
  messages::AnyMessage message;
  while (const auto sample = reader.next()) {
    if (sample->topic->type->decode(sample->payload, message) != nullptr) continue;
    if (const auto* status = std::get_if<ModuleStatus>(&message)) {
      for (const auto& input : status->inputs) {
        double& worst = felt.worst_age_error[status->module + " " + input.topic];
        worst = std::max(worst, input.age_error);
      }
      if (status->state == ModuleState::kDegraded && !status->last_error.empty())
        felt.troubles.push_back(status->module + ": " + status->last_error);
    }
    const auto* force = std::get_if<HapticForce>(&message);
    if (force == nullptr) continue;
    felt.at.push_back(seconds_from_ns(force->header.sim_time_ns));
    felt.force.push_back(force->force.norm());
    felt.age.push_back(force->contact_model_age);
    felt.limits.push_back(force->limits);
  }
  return felt;
}

/// Haptics and collision on the first host, deformation on the second unless told otherwise: every
/// stream but the statuses' crosses the link, two of them in many packets.
class TwoHosts {
 public:
  explicit TwoHosts(const BallScene& scene, const LinkFaults& faults = {}, long clock_ahead = 0,
                    const std::string& first_modules = "haptics, collision",
                    const std::string& second_modules = "deformation")
      : network_(faults, clock_ahead), scene_(scene) {
    std::ofstream(hosts_file()) << "palpate_hosts: 1\nhosts:\n"
                                << "  - {name: first, address: " << MadeNetwork::address(0)
                                << ", modules: [" << first_modules << "]}\n"
                                << "  - {name: second, address: " << MadeNetwork::address(1)
                                << ", modules: [" << second_modules << "]}\n";
  }

  void start(std::size_t host, std::vector<std::string> more) {
    std::vector<std::string> words = network_.on(host);
    const std::string program = words.front();
    words.erase(words.begin());
    words.insert(words.end(), {bin("palpate").string(), "run", scene_.file().string(), "--headless",
                               "--no-visualizer", "--hosts", hosts_file().string(), "--host",
                               host == 0 ? "first" : "second"});
    words.insert(words.end(), more.begin(), more.end());
    running_[host] = std::make_unique<Running>(program, joined(words, options_));
  }

  /// Runs the session to its end. @param meddle  called again and again while it runs
  /// @returns exit codes of both
  std::pair<int, int> run(const std::vector<std::string>& first,
                          const std::vector<std::string>& second = {},
                          const std::function<void(const std::string& said)>& meddle = {}) {
    start(0, first);
    start(1, second);
    return finish(meddle);
  }
  std::pair<int, int> finish(const std::function<void(const std::string& said)>& meddle = {}) {
    wait_until(
        [&] {
          if (meddle) meddle(running_[0]->listened());
          return running_[0]->child().ended().has_value();
        },
        kRunDeadline);
    const int of_first = running_[0]->wait_for_end(), of_second = running_[1]->wait_for_end();
    return {of_first, of_second};
  }
  Running& running(std::size_t host) { return *running_[host]; }
  MadeNetwork& network() { return network_; }
  std::filesystem::path recording() const { return scene_.folder() / "felt.mcap"; }

 private:
  std::filesystem::path hosts_file() const { return scene_.folder() / "hosts.yaml"; }

  MadeNetwork network_;
  const BallScene& scene_;
  bus::BusOptions options_ = own_bus_options();
  std::unique_ptr<Running> running_[2];
};

}  // namespace palpate::testing
