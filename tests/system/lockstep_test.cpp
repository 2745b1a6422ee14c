// Lockstep with the real processes, beside the same session in one process.
#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <random>

#include "modules/bus/dds_bus.h"
#include "modules/bus/keys.h"
#include "modules/recording/inspect.h"
#include "modules/recording/sample_reader.h"
#include "modules/runtime/session.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/scene_reader.h"
#include "palpate/child_process.h"
#include "tests/modules/runtime/own_bus.h"
#include "tests/palpate/ball_scene.h"
#include "tests/system/launched.h"

using namespace palpate;
using namespace palpate::testing;

namespace {

constexpr const char* kPress =
    "scripted: {start_m: [0, 0, 0.065], moves: [{to_m: [0.01, 0, 0.045], duration_s: 0.3}]}";
constexpr double kRunDeadline = 100;  // [s]; a run takes about one

/// `palpate run` to its end. @param meddle  called again and again while it runs
int run(const std::filesystem::path& scene, std::vector<std::string> more,
        const std::function<void(pid_t)>& meddle = {},
        const bus::BusOptions& options = own_bus_options()) {
  return Launched(scene, std::move(more), options).wait_for_end(kRunDeadline, meddle);
}

int run(const BallScene& scene, std::vector<std::string> more,
        const std::function<void(pid_t)>& meddle = {},
        const bus::BusOptions& options = own_bus_options()) {
  return run(scene.file(), std::move(more), meddle, options);
}

std::string bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<pid_t> children_of(pid_t parent) {
  const std::string id = std::to_string(parent);
  std::ifstream stream("/proc/" + id + "/task/" + id + "/children");
  return {std::istream_iterator<pid_t>(stream), {}};
}

}  // namespace

TEST_CASE(
    "lockstep: four processes leave the bytes that one process leaves, also when any of them "
    "is stopped for a while") {
  // Oracle: the same session in one process.
  const BallScene scene(kPress, "rates: {collision_hz: 300, deformation_hz: 100}\n");
  const auto one = scene.folder() / "one.mcap", four = scene.folder() / "four.mcap";
  REQUIRE(run(scene, {"--in-process", "--duration", "0.5", "--record", one.string()}) == 0);
  const std::string expected = bytes(one);
  REQUIRE(expected.size() > 10'000);

  REQUIRE(run(scene, {"--lockstep", "--duration", "0.5", "--record", four.string()}) == 0);
  CHECK(bytes(four) == expected);

  std::mt19937 random(7);
  int stops = 0;
  const auto stop_one = [&](pid_t launcher) {
    const auto children = children_of(launcher);
    if (children.empty()) return;
    const pid_t chosen = children[random() % children.size()];
    if (kill(chosen, SIGSTOP) != 0) return;
    ++stops;
    usleep(20'000);
    kill(chosen, SIGCONT);
  };
  REQUIRE(run(scene, {"--lockstep", "--duration", "0.5", "--record", four.string(), "--overwrite"},
              stop_one) == 0);
  CHECK(stops > 3);
  CHECK(bytes(four) == expected);
}

TEST_CASE("lockstep: nobody waits for laws of contacts that are rarer than 10 ms") {
  // Oracle: the same session in one process, byte for byte. At 90 Hz contacts get 10.67 ms old in
  // every tenth of a second and less between: a law that is dated by them, as if collision were
  // late, is none of its cycle, and haptics waited for that without end.
  const BallScene scene(kPress, "rates: {collision_hz: 90, deformation_hz: 250}\n");
  const auto one = scene.folder() / "one.mcap", four = scene.folder() / "four.mcap";
  REQUIRE(run(scene, {"--in-process", "--duration", "0.7", "--record", one.string()}) == 0);
  REQUIRE(run(scene, {"--lockstep", "--duration", "0.7", "--record", four.string()}) == 0);
  CHECK(bytes(four) == bytes(one));
}

TEST_CASE("lockstep: with keys, the processes leave the same bytes") {
  // Oracle: the same session in one process, byte for byte.
  const BallScene scene(kPress);
  const auto keys = scene.folder() / "keys";
  bus::make_keys(keys, std::chrono::hours(1));
  const auto one = scene.folder() / "one.mcap", four = scene.folder() / "four.mcap";
  REQUIRE(run(scene, {"--in-process", "--duration", "0.5", "--record", one.string()}) == 0);
  REQUIRE(run(scene, {"--lockstep", "--duration", "0.5", "--record", four.string(), "--secure",
                      keys.string()}) == 0);
  CHECK(bytes(four) == bytes(one));
}

TEST_CASE("lockstep: a solid that follows the touch changes its mesh alike in four processes") {
  // Oracle: the same session in one process, byte for byte; the recording holds surfaces of rising
  // generations, each before the first positions of it, and every positions message is of one told.
  const Scripts files;
  scene::Scene liver =
      scene::load_scene(std::filesystem::path(PALPATE_SOURCE_DIR) / "scenes" / "liver_solid.yaml");
  liver.organs[0].solid.refine.follow = true;
  liver.organs[0].solid.refine.nodes = 800;
  const Vec3 start(-0.020, -0.082, 0.013);
  scene::ScriptedDevice script;
  script.start = start;
  script.moves = {{start + Vec3(0, 0.016, 0), 0.3}, {start + Vec3(0.02, 0.016, 0), 0.5}};
  liver.probes[0].device = script;
  const auto file = files.folder() / "follow.yaml";
  std::ofstream(file) << scene::resolved_text(liver);
  const auto one = files.folder() / "one.mcap", four = files.folder() / "four.mcap";
  REQUIRE(run(file, {"--in-process", "--duration", "1", "--record", one.string()}) == 0);
  REQUIRE(run(file, {"--lockstep", "--duration", "1", "--record", four.string()}) == 0);
  CHECK(bytes(four) == bytes(one));

  recording::SampleReader reader(one);
  std::map<std::uint32_t, std::size_t> nodes;  // of each generation told
  messages::AnyMessage message;
  std::uint32_t shown = 0;
  while (const auto sample = reader.next()) {
    REQUIRE(sample->topic->type->decode(sample->payload, message) == nullptr);
    if (const auto* surface = std::get_if<SurfaceTopology>(&message)) {
      nodes[surface->generation] = surface->rest_positions.size();
    } else if (const auto* positions = std::get_if<NodePositions>(&message)) {
      REQUIRE(nodes.contains(positions->generation));
      CHECK(nodes[positions->generation] == positions->positions.size());
      CHECK(positions->generation >= shown);
      shown = positions->generation;
    }
  }
  CHECK(shown > 5);
  CHECK(nodes.size() >= shown);
}

TEST_CASE("lockstep: a recorder that was stopped gets what the others said before they left") {
  // Oracle: the same session in one process. The recorder sleeps from the middle to the end of the
  // session, and wakes when whoever would leave without waiting for it has had time to.
  const BallScene scene(kPress, "rates: {collision_hz: 300, deformation_hz: 100}\n");
  const auto one = scene.folder() / "one.mcap", late = scene.folder() / "late.mcap";
  REQUIRE(run(scene, {"--in-process", "--duration", "0.5", "--record", one.string()}) == 0);

  const scene::Scene loaded = scene::load_scene(scene.file());
  const bus::BusOptions options = own_bus_options();
  std::map<std::string, std::unique_ptr<launcher::ChildProcess>> children;
  for (const char* name : {"deformation", "collision", "haptics", "recorder"}) {
    std::vector<std::string> arguments{scene.file().string()};
    if (name == std::string("recorder")) {
      arguments = {late.string(), "--scene", scene.file().string()};
    }
    arguments.insert(arguments.end(),
                     {"--session", options.session, "--domain", std::to_string(options.domain),
                      "--lockstep", "haptics,collision,deformation,recorder"});
    children[name] = std::make_unique<launcher::ChildProcess>(
        std::filesystem::path(PALPATE_BIN_DIR) / (std::string("palpate-") + name), arguments);
  }
  bus::BusOptions every_sample = options;
  every_sample.every_sample = true;
  bus::DdsBus bus(every_sample);
  runtime::Session session(bus, scene::scene_digest(loaded), runtime::Session::Kind::kLockstep);
  runtime::SessionConductor conductor(bus);
  auto scenes = bus.writer(bus::kScene);
  auto statuses = bus.reader(bus::kModuleStatus);
  SceneDescription description = runtime::scene_description(loaded);
  description.header.source_time_ns = runtime::CycleGrid::kSetUp;
  scenes.write(description);
  std::map<std::string, ModuleStatus> heard;
  const auto wait_for = [&](const auto& condition) {
    return wait_until(
        [&] {
          session.poll();
          ModuleStatus status;
          while (statuses.take(status)) heard[status.module] = status;
          return condition();
        },
        kRunDeadline);
  };
  const auto done = [&](std::size_t modules, std::int64_t until_ns) {
    return std::count_if(heard.begin(), heard.end(), [&](const auto& module) {
             return module.second.state >= ModuleState::kReady &&
                    module.second.header.sim_time_ns >= until_ns;
           }) >= std::ptrdiff_t(modules);
  };
  constexpr std::int64_t kHalf = 250'000'000, kEnd = 500'000'000;
  REQUIRE(wait_for([&] { return done(4, 0); }));
  conductor.grant(session.state(), kHalf);
  REQUIRE(wait_for([&] { return done(4, kHalf); }));
  children.at("recorder")->signal(SIGSTOP);
  conductor.grant(session.state(), kEnd);
  REQUIRE(wait_for([&] { return done(3, kEnd); }));
  conductor.command(session.state(), SessionCommand::kStop);
  const auto all_ended = [&] {
    return std::all_of(children.begin(), children.end(),
                       [](const auto& child) { return child.second->ended().has_value(); });
  };
  wait_until([&] { return children.at("deformation")->ended().has_value(); }, 0.5);
  children.at("recorder")->signal(SIGCONT);
  REQUIRE(wait_until(all_ended));
  for (const auto& [name, child] : children) {
    INFO(name);
    for (const auto& line : child->take_lines()) UNSCOPED_INFO(line);
    CHECK(child->ended() == 0);
  }
  CHECK(bytes(late) == bytes(one));
}

/// All samples from a simulated time on: topic and bytes.
std::vector<std::pair<std::string, std::vector<std::uint8_t>>> samples_from(
    const std::filesystem::path& file, std::int64_t from_ns) {
  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> samples;
  recording::SampleReader reader(file);
  while (const auto sample = reader.next()) {
    if (messages::header_of(sample->payload).source_time_ns < from_ns) continue;
    samples.emplace_back(sample->topic->name, sample->payload);
  }
  return samples;
}

TEST_CASE("lockstep: processes go on from a snapshot, their own or one process' own") {
  // Oracle: the end of a recording that was never interrupted; the other driver's snapshot.
  const BallScene scene(kPress, "rates: {collision_hz: 300, deformation_hz: 100}\n");
  const auto in = [&](const char* name) { return (scene.folder() / name).string(); };
  REQUIRE(run(scene, {"--in-process", "--duration", "0.5", "--record", in("whole.mcap")}) == 0);
  const auto expected = samples_from(in("whole.mcap"), 300'000'000);
  REQUIRE(expected.size() > 400);
  for (const char* at : {"0.2953", "0.3"}) {  // between two cycles, too
    INFO(at);
    REQUIRE(run(scene, {"--lockstep", "--duration", "0.35", "--snapshot-at", at, "--snapshot",
                        in("four.snapshot"), "--overwrite"}) == 0);
    REQUIRE(run(scene, {"--in-process", "--duration", "0.3", "--snapshot-at", at, "--snapshot",
                        in("one.snapshot"), "--overwrite"}) == 0);
    CHECK(bytes(in("four.snapshot")) == bytes(in("one.snapshot")));
  }
  CHECK_FALSE(std::filesystem::exists(in("four.snapshot.haptics")));

  for (const char* driver : {"--in-process", "--lockstep"}) {
    INFO(driver);
    REQUIRE(run(scene, {driver, "--duration", "0.5", "--from-snapshot", in("one.snapshot"),
                        "--record", in("rest.mcap"), "--overwrite"}) == 0);
    CHECK(samples_from(in("rest.mcap"), 300'000'000) == expected);
  }
}

TEST_CASE("snapshots: what cannot be gone on from is refused before anything starts") {
  // Oracle: exit code 2.
  const BallScene scene(kPress);
  const auto file = (scene.folder() / "at.snapshot").string();
  REQUIRE(run(scene, {"--in-process", "--duration", "0.1", "--snapshot-at", "0.1", "--snapshot",
                      file}) == 0);
  const std::vector<std::vector<std::string>> refused{
      {"--in-process", "--duration", "0.1", "--snapshot-at", "0.1", "--snapshot", file},
      {"--in-process", "--duration", "0.1", "--from-snapshot", file},
      {"--in-process", "--duration", "1", "--from-snapshot", file, "--set",
       "organs[0].tissue.youngs_modulus_pa=8e3"},
      {"--lockstep", "--duration", "1", "--from-snapshot", scene.file().string()},
      {"--duration", "1", "--from-snapshot", file},
      {"--in-process", "--duration", "1", "--snapshot-at", "0.5"},
      {"--in-process", "--duration", "1", "--snapshot-at", "2", "--snapshot", file + "2"}};
  for (const auto& options : refused) CHECK(run(scene, options) == 2);
  CHECK(run(scene, {"--in-process", "--duration", "0.2", "--from-snapshot", file}) == 0);
}

TEST_CASE("lockstep: two runs that were given one session's name do not hear each other") {
  // Oracle: the same session in one process. Each launcher runs beside the other's processes.
  const BallScene scene(kPress, "rates: {collision_hz: 300, deformation_hz: 100}\n");
  const auto one = scene.folder() / "one.mcap", a = scene.folder() / "a.mcap",
             b = scene.folder() / "b.mcap";
  REQUIRE(run(scene, {"--in-process", "--duration", "0.5", "--record", one.string()}) == 0);
  const bus::BusOptions same = own_bus_options();
  const auto run_to = [&](const std::filesystem::path& file,
                          const std::function<void(pid_t)>& meddle) {
    return run(scene, {"--lockstep", "--duration", "0.5", "--record", file.string()}, meddle, same);
  };
  std::optional<int> second;
  const auto beside = [&](pid_t) {
    if (!second) second = run_to(b, {});
  };
  REQUIRE(run_to(a, beside) == 0);
  CHECK(second == 0);
  CHECK(bytes(a) == bytes(one));
  CHECK(bytes(b) == bytes(one));
}

TEST_CASE("lockstep: a run that is interrupted leaves a whole recording") {
  // Oracle: the reader, which tells torn files.
  const BallScene scene(kPress, "rates: {collision_hz: 300, deformation_hz: 100}\n");
  const auto file = scene.folder() / "cut.mcap";
  const auto interrupt = [&](pid_t launcher) {
    std::error_code none;
    if (std::filesystem::file_size(file, none) > 100'000 && !none) kill(launcher, SIGINT);
  };
  run(scene, {"--lockstep", "--duration", "1000", "--record", file.string()}, interrupt);
  const recording::RecordingSummary summary = recording::summarize(file);
  CHECK_FALSE(summary.torn);
  CHECK(summary.warnings.empty());
}

TEST_CASE("lockstep: without an end there is nothing to run") {
  // Oracle: exit codes of a program.
  const BallScene scene(kPress);
  CHECK(run(scene, {"--lockstep"}) == 2);
  CHECK(run(scene, {"--in-process"}) == 2);
}
