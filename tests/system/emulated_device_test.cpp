// palpate-emulated-device beside `palpate run`: a device in a hand, over loopback DDS.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <sstream>

#include "modules/scene/scene_reader.h"
#include "tests/system/launched.h"

using namespace palpate;
using namespace palpate::testing;
using Catch::Contains;

namespace {

constexpr const char* kAboveTheBall = "topic: {start_m: [0, 0, 0.0605]}";  // by 0.5 mm

/// The device's program, joined to a session.
struct Device : Running {
  Device(const std::filesystem::path& scene, const bus::BusOptions& session,
         std::vector<std::string> more)
      : Running(bin("palpate-emulated-device"), arguments(scene, session, std::move(more))) {}

  static std::vector<std::string> arguments(const std::filesystem::path& scene,
                                            const bus::BusOptions& session,
                                            std::vector<std::string> more) {
    more.insert(more.begin(), scene.string());
    return joined(std::move(more), session);
  }
};

struct Row {
  double time;
  Vec3 position, force;
};
std::vector<Row> rows_of(const std::filesystem::path& table) {
  std::ifstream stream(table);
  std::vector<Row> rows;
  std::string line;
  for (std::getline(stream, line); std::getline(stream, line);) {
    std::istringstream numbers(line);
    std::vector<double> values;
    for (std::string number; std::getline(numbers, number, ',');)
      values.push_back(std::stod(number));
    if (values.size() != 8) break;  // cut short
    rows.push_back(
        {values[1], {values[2], values[3], values[4]}, {values[5], values[6], values[7]}});
  }
  return rows;
}

/// A shipped scene with its probe moved by a driver, as text.
std::string driven(const std::string& name, const Vec3& start) {
  scene::Scene scene =
      scene::load_scene(std::filesystem::path(PALPATE_SOURCE_DIR) / "scenes" / name);
  scene.probes[0].device = scene::TopicDevice{start};
  return scene::resolved_text(scene);
}

}  // namespace

TEST_CASE("emulated device: over DDS a solid liver pushes back as hard as the hand, and rests") {
  // Oracle: momentum. Over the last second the motors' mean force is the push, less what moved mass
  // and damping: m Δv + b Δx over 1 s. Velocities are differences over 5 ms. Nothing of a hand
  // damps this device; a loop that made energy would swing by the 2 mm that it is pressed in.
  constexpr double kPush = 0.2, kMass = 0.1, kDamping = 0.2;
  const Scripts files;
  const auto scene = files.folder() / "liver.yaml", table = files.folder() / "device.csv";
  std::ofstream(scene) << driven("liver_solid.yaml", Vec3(-0.020, -0.0726, 0.013));
  Launched session(scene, {});
  REQUIRE(session.wait_for_text("real time"));  // it joins a session that runs
  Device device(scene, session.options(),
                {"--device", "{axis: [0, 1, 0], hand: {push_n: [0, 0.2, 0]}}", "--duration", "4",
                 "--csv", table.string()});
  CHECK(device.wait_for_end() == 0);
  INFO(device.said() << session.said());
  CHECK_THAT(device.said(), Contains("fingertip: 4.0 s at "));

  const std::vector<Row> rows = rows_of(table);
  REQUIRE(rows.size() > 2000);
  const auto last = rows.end() - 1;
  const auto begin = std::find_if(rows.begin() + 5, rows.end(),
                                  [&](const Row& row) { return row.time >= last->time - 1; });
  // One that makes energy swings in every tenth of it, one that drifts is elsewhere in the last
  // than in the first; a host's pause shows in one or two, and in the middle of none.
  std::array<std::vector<double>, 10> tenths;
  std::array<double, 10> middles, swings;
  double impulse = 0;
  bool on_rail = true;
  for (auto row = begin + 1; row != rows.end(); ++row) {
    impulse += row->force.y() * (row->time - (row - 1)->time);
    on_rail = on_rail && row->position.x() == begin->position.x();
    const double part = (row->time - begin->time) / (last->time - begin->time);
    const std::size_t tenth = std::min<std::size_t>(static_cast<std::size_t>(10 * part), 9);
    tenths[tenth].push_back(row->position.y());
  }
  for (std::size_t i = 0; i < swings.size(); ++i) {
    REQUIRE(!tenths[i].empty());
    std::ranges::sort(tenths[i]);
    swings[i] = tenths[i].back() - tenths[i].front();
    middles[i] = tenths[i][tenths[i].size() / 2];
  }
  const auto [lowest, highest] = std::ranges::minmax(middles);
  std::ranges::sort(swings);
  const auto speed = [&](std::vector<Row>::const_iterator row) {
    return (row->position - (row - 5)->position).y() / (row->time - (row - 5)->time);
  };
  const double span = last->time - begin->time;
  const double taken =
      kMass * (speed(last) - speed(begin)) + kDamping * (last->position - begin->position).y();
  INFO("mean force " << impulse / span << " N, swing " << swings[5] << ", at most " << swings[9]
                     << " m in a tenth of a second, which lie " << highest - lowest << " m apart");
  CHECK(std::abs(kPush * span + impulse - taken) < 0.02 * kPush * span);
  CHECK(swings[7] < 5e-5);
  CHECK(swings[9] < 5e-4);
  CHECK(highest - lowest < 5e-5);  // with a swing of as much 0.1 mm in the whole second
  CHECK(on_rail);
}

TEST_CASE("emulated device: ends with its session, and at once when told to") {
  // Oracle: its exit codes and what it says.
  const BallScene scene(kAboveTheBall);
  const std::string push = "{axis: [0, 0, 1], hand: {push_n: [0, 0, -0.1], damping_n_s_per_m: 3}}";
  Launched session(scene, {"--duration", "5"});  // on a busy processor a program takes a while
  Device stopped(scene.file(), session.options(), {"--device", push});
  REQUIRE(stopped.wait_for_text("1.0 s  at 0.00 0.00"));
  stopped.child().signal(SIGTERM);
  CHECK(stopped.wait_for_end() == 0);
  CHECK_THAT(stopped.said(), Contains("finger: ") && Contains(" mm, force "));
  Device again(scene.file(), session.options(), {"--device", "{kind: omega}"});
  CHECK(again.wait_for_end() == 0);  // the session is over
  CHECK_THAT(again.said(), Contains("finger: "));
  CHECK(session.wait_for_end() == 0);
}

TEST_CASE("emulated device: says what it waits for, and waits no longer than it is told") {
  // Oracle: the messages, exit codes 1 and 130; nobody starts this session.
  const BallScene scene(kAboveTheBall);
  const bus::BusOptions session = own_bus_options();
  Device device(scene.file(), session, {"--duration", "1"});
  CHECK(device.wait_for_end() == 1);
  const std::string name =
      "session " + session.session + " in domain " + std::to_string(session.domain);
  CHECK_THAT(device.said(), Contains("waiting for " + name + " to begin\n"));
  CHECK_THAT(device.said(), Contains(name + " has not begun within 10 s\n"));

  // Stopped before there is anything to sum up.
  const std::string table = (scene.folder() / "table.csv").string();
  Device stopped(scene.file(), session, {"--csv", table});
  REQUIRE(stopped.wait_for_text("waiting for " + name + " to begin\n"));
  Device second(scene.file(), session, {"--csv", table});  // which would write over the first's
  CHECK(second.wait_for_end() == kExitBadInput);
  CHECK_THAT(second.said(), Contains(table + ": another program is writing it"));
  stopped.child().signal(SIGTERM);
  CHECK(stopped.wait_for_end() == kExitStopped);
  CHECK_THAT(stopped.said(), Contains("stopped; " + name + " had not begun") &&
                                 !Contains("finger: ") && !Contains("on time"));
}

TEST_CASE("emulated device: takes the names of shipped scenes") {
  // Oracle: the message is about the scene's probe; the scene is no file here.
  Device device("stomach_probe", own_bus_options(), {});
  CHECK(device.wait_for_end() == 2);
  CHECK_THAT(device.said(), Contains("stomach_probe.yaml has no probe with device topic"));
}

TEST_CASE("emulated device: what it cannot do is one line and exit code 2") {
  // Oracle: the messages.
  const BallScene driven(kAboveTheBall),
      scripted("scripted: {start_m: [0, 0, 0.09], moves: [{wait_s: 1}]}");
  struct Case {
    const BallScene& scene;
    std::vector<std::string> more;
    std::string said;
  };
  for (const Case& wrong :
       {Case{driven, {"--probe", "thumb"}, "has no probe 'thumb'"},
        Case{scripted, {"--probe", "finger"}, "its device must be topic"},
        Case{scripted, {}, "has no probe with device topic"},
        Case{driven, {"--device", "{mass: 1}"}, "--device:1: "},
        Case{driven, {"--device", "{hand: {push_n: [0, 0, -1e9]}}"}, "key 'hand.push_n'"},
        Case{driven, {"--device", "{axis: [0, 0, 0]}"}, "axis must be a direction"},
        Case{driven, {"--csv", "/nowhere/table.csv"}, "/nowhere/table.csv: cannot be written"}}) {
    Device device(wrong.scene.file(), own_bus_options(), wrong.more);
    CHECK(device.wait_for_end() == 2);
    CHECK_THAT(device.said(), Contains(wrong.said));
  }
}
