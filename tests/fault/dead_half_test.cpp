// Of two deformation processes one dies while a finger presses an organ of each: what its own
// organs gave fades, the other's stays, and it returns.
#include <catch2/catch.hpp>
#include <csignal>

#include "modules/bus/dds_bus.h"
#include "modules/core/units.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/session.h"
#include "modules/scene/scene_reader.h"
#include "palpate/child_process.h"
#include "tests/modules/runtime/own_bus.h"
#include "tests/palpate/two_balls_scene.h"

using namespace palpate;
using namespace palpate::testing;

namespace {

/// `palpate run` of two processes, and what its bus says.
struct SplitRun {
  bus::BusOptions options = own_bus_options();
  launcher::ChildProcess palpate;
  bus::DdsBus bus{options};
  bus::Reader<HapticForce> forces = bus.reader(bus::kHapticForce);
  bus::Reader<ModuleStatus> statuses = bus.reader(bus::kModuleStatus);
  HapticForce newest[2];
  double least[2] = {0, 0};  ///< since it was cleared [N]
  std::map<std::string, ModuleStatus> modules;

  explicit SplitRun(const TwoBallsScene& scene)
      : palpate(std::filesystem::path(PALPATE_BIN_DIR) / "palpate",
                {"run", scene.file().string(), "--headless", "--session", options.session,
                 "--domain", std::to_string(options.domain), "--duration", "60"}) {}

  template <class Condition>
  bool wait(const Condition& condition, double deadline = kDeadline) {
    return wait_until(
        [&] {
          for (const auto& line : palpate.take_lines()) UNSCOPED_INFO(line);
          HapticForce force;
          while (forces.take(force)) {
            newest[force.probe] = force;
            least[force.probe] = std::min(least[force.probe], force.force.norm());
          }
          ModuleStatus status;
          while (statuses.take(status)) modules[status.module] = status;
          return condition();
        },
        deadline);
  }
  double felt(std::size_t probe) const { return newest[probe].force.norm(); }
};

}  // namespace

TEST_CASE("dead half: only the force of its own organs fades, and it returns") {
  // Oracle: each finger presses a ball of its own; the forces before, and that the launcher starts
  // again what died. A killed half may have a successor, which goes on in the kept state, before
  // its law is stale: then nothing fades. One that hangs has none for seconds, so its law must
  // fade.
  const int signal = GENERATE(SIGKILL, SIGSTOP);
  const TwoBallsScene scene("2");
  SplitRun run(scene);
  REQUIRE(run.wait([&] { return run.felt(0) > 0.05 && run.felt(1) > 0.05; }));
  REQUIRE(run.wait([&] { return run.newest[0].header.sim_time_ns > 1'500'000'000; }));
  const double before = run.felt(0);
  const auto first = run.modules.at("deformation_2").process_id;
  run.least[0] = before;
  kill(static_cast<pid_t>(first), signal);
  if (signal == SIGSTOP) {
    REQUIRE(run.wait([&] { return run.felt(1) == 0; }));
    CHECK((run.newest[1].limits & kForceStaleFade) != 0);
  }
  REQUIRE(run.wait([&] {
    const auto& status = run.modules.at("deformation_2");
    return status.process_id != first && status.state >= ModuleState::kRunning;
  }));
  // Longer than the law of the one that died is believed: what is felt then is its successor's.
  const auto since = run.newest[1].header.sim_time_ns;
  CHECK(run.wait([&] {
    return run.newest[1].header.sim_time_ns > since + kNanosecondsPerSecond && run.felt(1) > 0.05;
  }));
  CHECK(run.least[0] > 0.8 * before);
  CHECK(run.felt(0) == Approx(before).epsilon(0.05));
  run.palpate.signal(SIGTERM);
  CHECK(run.wait([&] { return run.palpate.ended().has_value(); }));
}
