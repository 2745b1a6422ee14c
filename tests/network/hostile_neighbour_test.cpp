// A session that is open to its network, and a neighbour there who takes no part in it.
#include <catch2/catch.hpp>
#include <chrono>
#include <iostream>
#include <sstream>

#include "tests/modules/bus/hostile_packets.h"
#include "tests/modules/bus/stranger.h"
#include "tests/network/two_hosts.h"
#include "tests/system/resident_memory.h"

using namespace palpate;
using namespace palpate::testing;
using palpate::bus::testing::any_packet;
using palpate::bus::testing::Bytes;
using palpate::bus::testing::packets_to_send;
using palpate::bus::testing::Stranger;

namespace {

constexpr int kPortsInUse = 2 * 5;  // launcher, recorder and three modules
constexpr int kBurst = 20;  // a thousand times a second; more at once would not fit the socket
constexpr int kLookEvery = 2000;  // packets: at memory

/// Resident memory of a program and its children [kB].
std::map<pid_t, double> memory_of(pid_t program) {
  const std::string process = "/proc/" + std::to_string(program);
  std::ifstream listed(process + "/task/" + std::to_string(program) + "/children");
  std::vector<pid_t> all{program};
  for (pid_t child = 0; listed >> child;) all.push_back(child);
  std::map<pid_t, double> memory;
  for (const pid_t each : all) {
    if (const double resident = resident_memory(each); resident > 0) memory[each] = resident;
  }
  return memory;
}

/// Longest time without a sample, and with less than half of a force [s].
struct Gaps {
  double silent = 0, weak = 0;
};
Gaps gaps_of(const Felt& felt, double from, double force) {
  Gaps gaps;
  double last = from, strong = from;
  felt.during(from, 1e9, [&](std::size_t i) {
    gaps.silent = std::max(gaps.silent, felt.at[i] - last);
    last = felt.at[i];
    if (felt.force[i] > 0.5 * force) strong = felt.at[i];
    gaps.weak = std::max(gaps.weak, felt.at[i] - strong);
  });
  return gaps;
}

/// By all modules, as the summary says.
int refused(const std::string& summary) {
  int all = 0;
  std::istringstream lines(summary);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("packets from a stranger refused") != std::string::npos) all += std::stoi(line);
  }
  return all;
}

bool passed(std::chrono::steady_clock::time_point since, double seconds) {
  return std::chrono::steady_clock::now() - since > std::chrono::duration<double>(seconds);
}

}  // namespace

TEST_CASE("hostile neighbour: a session goes on pressing under packets from the network") {
  // Oracle: nobody ends; the force is never above that of the same pose without them by a tenth,
  // and not below half of it for a second; memory of each process grows by less than half.
  const std::string why = no_made_network();
  if (!why.empty()) {
    std::cout << "SKIPPED: " << why << '\n';
    return;
  }
  const BallScene scene(kHeldPress);
  const auto recording = scene.folder() / "felt.mcap";
  MadeNetwork network;
  const bus::BusOptions options = own_bus_options();
  std::vector<std::string> words = network.on(0);
  const std::string program = words.front();
  words.erase(words.begin());
  words.insert(words.end(), {"/usr/bin/env", "PALPATE_INTERFACES=" + MadeNetwork::address(0),
                             "PALPATE_PEERS=" + MadeNetwork::address(1), bin("palpate").string(),
                             "run", scene.file().string(), "--headless", "--no-visualizer",
                             "--no-restart", "--record", recording.string()});
  Running session(program, joined(words, options));
  REQUIRE(session.wait_for_text("3.0 s  real"));

  Stranger stranger(options.domain, network.socket_on(1), MadeNetwork::address(1),
                    MadeNetwork::address(0));
  const std::vector<Bytes> overheard = stranger.overhear(60);
  REQUIRE(overheard.size() >= 4);
  const pid_t launcher = session.child().process_id();
  const std::map<pid_t, double> before = memory_of(launcher);
  REQUIRE(before.size() >= 5);
  std::map<pid_t, double> most = before;
  std::mt19937_64 random(1);
  const int count = packets_to_send(60'000);
  auto burst_at = std::chrono::steady_clock::now();
  for (int sent = 0; sent < count; ++sent) {
    stranger.send(any_packet(random, overheard), Stranger::kFirstOffset + sent % kPortsInUse);
    if ((sent + 1) % kBurst != 0) continue;
    burst_at += std::chrono::milliseconds(1);
    std::this_thread::sleep_until(burst_at);
    if ((sent + 1) % kLookEvery != 0) continue;
    REQUIRE_FALSE(session.child().ended().has_value());
    for (const auto& [process, memory] : memory_of(launcher))
      most[process] = std::max(most[process], memory);
  }
  const auto after = std::chrono::steady_clock::now();
  wait_until([&] { return passed(after, 1); });
  session.child().signal(SIGTERM);
  CHECK(session.wait_for_end() == 0);
  CHECK(refused(session.said()) > count / 4);  // the others are sound, or were lost on the way

  const Felt felt = felt_of(recording);
  const double force = felt.mean_force(2, 3);
  REQUIRE(force > 0.02);
  const Gaps gaps = gaps_of(felt, 2, force);
  CHECK(most.size() == before.size());  // nobody was started again
  double growth = 0;
  for (const auto& [process, memory] : most) growth = std::max(growth, memory / before.at(process));
  CHECK(growth < 1.5);
  CHECK(gaps.silent < 1);
  CHECK(gaps.weak < 1);
  CHECK(felt.largest_force(2, 1e9) < 1.1 * force);
  CHECK(felt.mean_force(felt.at.back() - 0.5, 1e9) == Approx(force).epsilon(0.05));
  std::cout << count << " packets from a neighbour, " << refused(session.said())
            << " refused by the modules: memory at most " << growth
            << " times as much, longest without a force's sample " << gaps.silent
            << " s, with less than half of the force " << gaps.weak << " s, largest force "
            << felt.largest_force(2, 1e9) / force << " of what it was\n";
}
