#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "modules/bus/dds_bus.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "modules/runtime/clock.h"
#include "tests/modules/own_domain.h"
#include "tests/visualizer/display_or_skip.h"
#include "tests/visualizer/fake_mouse.h"
#include "tests/visualizer/fake_session.h"
#include "visualizer/offscreen_display.h"
#include "visualizer/overlay.h"
#include "visualizer/surface_press.h"

using namespace palpate;
using visualizer::testing::positions_of;
using visualizer::testing::topology_of;

namespace {

constexpr double kDeadline = 40;  // [s] drawing in software on a busy machine takes its time

bool wait_until(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kDeadline);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

/// palpate-visualizer as a child, a scene of one ball, and the other modules played by the test.
class Session {
 public:
  explicit Session(const std::vector<std::string>& options)
      : folder(std::filesystem::temp_directory_path() /
               ("palpate_visualizer_test_" + std::to_string(getpid()))),
        bus_({palpate::testing::own_domain(1), "visualizer_test", "test"}),
        surfaces(bus_.writer(bus::kSurface)),
        positions(bus_.writer(bus::kNodePositions)),
        probes(bus_.writer(bus::kProbeState)),
        controls(bus_.writer(bus::kSessionControl)),
        statuses(bus_.reader(bus::kModuleStatus)),
        inputs(bus_.reader(bus::kProbeInput)),
        commands(bus_.reader(bus::kSessionControl)) {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    const auto ball = geometry::make_ball(0.05, 2);
    geometry::write_surface(ball, folder / "ball.ply");
    topology = topology_of(ball);
    std::ofstream(folder / "scene.yaml")
        << "palpate_scene: 1\norgans:\n  - {name: ball, mesh: {file: ball.ply}}\n"
           "probes:\n  - name: finger\n    shape: {sphere: {radius_m: 0.01}}\n"
           "    device: {mouse: {start_m: [0, 0, 0.1]}}\n";
    child_ = fork();
    if (child_ == 0) become_visualizer(options);
  }
  ~Session() {
    if (child_ > 0) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    std::filesystem::remove_all(folder);
  }

  void start() {
    SessionControl control;
    control.command = SessionCommand::kStart;
    control.header.source_time_ns = control.start_time_ns = runtime::monotonic_now_ns();
    controls.write(control);
    surfaces.write(topology);
  }
  /// One more sample of the ball and the probe.
  void play() {
    auto ball = positions_of(topology, seconds_ += 0.05);
    positions.write(ball);
    ProbeState probe;
    probe.header.sim_time_ns = ball.header.sim_time_ns;
    ProbeState wanted;  // the finger is where the mouse wants it
    while (inputs.take(wanted)) finger = wanted.pose.position;
    probe.pose.position = finger;
    probes.write(probe);
  }
  bool play_until(const std::function<bool()>& condition) {
    return wait_until([&] {
      play();
      return condition();
    });
  }
  /// True when the visualizer reports this state.
  bool reports(ModuleState state) {
    ModuleStatus status;
    while (statuses.take(status)) {
      if (status.module == "visualizer") newest_state_ = status.state;
    }
    return newest_state_ == state;
  }
  std::size_t frame_count() const {
    std::size_t count = 0;
    if (!std::filesystem::exists(folder / "frames")) return 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "frames")) {
      count += entry.path().extension() == ".png";
    }
    return count;
  }
  void signal(int number) { kill(child_, number); }
  /// Exit code of the visualizer; -1 if it did not end in time, 1000 + n if signal n ended it.
  int exit_code() {
    int status = 0;
    if (!wait_until([&] { return waitpid(child_, &status, WNOHANG) == child_; })) return -1;
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }

  std::filesystem::path folder;

 private:
  [[noreturn]] void become_visualizer(const std::vector<std::string>& options) const {
    const std::string program = std::string(PALPATE_BIN_DIR) + "/palpate-visualizer";
    std::vector<std::string> words{program,     "scene.yaml",
                                   "--session", "visualizer_test",
                                   "--domain",  std::to_string(palpate::testing::own_domain(1))};
    words.insert(words.end(), options.begin(), options.end());
    std::vector<char*> arguments;
    for (auto& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (chdir(folder.c_str()) != 0) _exit(126);
    const int log = open("stderr.txt", O_CREAT | O_WRONLY, 0600);
    dup2(log, STDERR_FILENO);
    execv(program.c_str(), arguments.data());
    _exit(127);
  }

  bus::DdsBus bus_;

 public:
  bus::Writer<SurfaceTopology> surfaces;
  bus::Writer<NodePositions> positions;
  bus::Writer<ProbeState> probes;
  bus::Writer<SessionControl> controls;
  bus::Reader<ModuleStatus> statuses;
  bus::Reader<ProbeState> inputs;
  bus::Reader<SessionControl> commands;
  SurfaceTopology topology;
  Vec3 finger = Vec3(0, 0, 0.1);

 private:
  pid_t child_ = -1;
  double seconds_ = 0;
  ModuleState newest_state_ = ModuleState::kStarting;
};

}  // namespace

TEST_CASE("visualizer process: draws a sequence off-screen and ends well on SIGTERM",
          "[visualizer][system]") {
  // Oracle: files and exit code. Positions before the surface, and of an unknown organ, come first.
  // Nobody says that the session runs: in a replay of a lockstep's recording nobody does.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Session session({"--headless", "--frames", "frames", "--frame-interval-s", "0.5", "--screenshot",
                   "last.png"});
  for (const std::uint32_t organ : {0u, 7u}) {
    auto stray = positions_of(session.topology);
    stray.organ = organ;
    session.positions.write(stray);
  }
  REQUIRE(session.play_until([&] { return session.reports(ModuleState::kReady); }));
  session.surfaces.write(session.topology);
  REQUIRE(session.play_until([&] { return session.frame_count() >= 3; }));
  session.signal(SIGTERM);
  CHECK(session.exit_code() == 0);
  CHECK(std::filesystem::file_size(session.folder / "last.png") > 10'000);
  for (const auto& entry : std::filesystem::directory_iterator(session.folder / "frames")) {
    CHECK(entry.path().filename().string().starts_with("frame_0000"));
    CHECK(entry.path().extension() == ".png");  // no half-written ones
  }
}

TEST_CASE("visualizer process: pictures that find no place are told of, and it goes on to its end",
          "[visualizer][fault]") {
  // Oracle: exit code 1 and the reason, once while it goes on and once at its end. The folder is
  // gone when the second picture comes.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Session session({"--headless", "--frames", "frames", "--frame-interval-s", "0.5"});
  REQUIRE(session.play_until([&] { return session.reports(ModuleState::kReady); }));
  session.start();
  session.surfaces.write(session.topology);
  REQUIRE(session.play_until([&] { return session.frame_count() >= 1; }));
  std::filesystem::remove_all(session.folder / "frames");
  REQUIRE(session.play_until([&] { return session.reports(ModuleState::kDegraded); }));
  session.signal(SIGTERM);
  CHECK(session.exit_code() == 1);
  std::stringstream said;
  said << std::ifstream(session.folder / "stderr.txt").rdbuf();
  INFO(said.str());
  CHECK(said.str().find("error: frames/frame_") != std::string::npos);
  CHECK(said.str().find("missing: frames/frame_") != std::string::npos);
}

TEST_CASE("visualizer process: goes on when the deformation falls silent", "[visualizer][fault]") {
  // Oracle: it stays running, keeps publishing its status, and still writes the last picture.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Session session({"--headless", "--screenshot", "last.png"});
  REQUIRE(session.play_until([&] { return session.reports(ModuleState::kReady); }));
  session.start();
  REQUIRE(session.play_until([&] { return session.reports(ModuleState::kRunning); }));
  ModuleStatus status;
  REQUIRE(wait_until([&] {  // no more positions: their age grows
    while (session.statuses.take(status)) {
      for (const auto& input : status.inputs) {
        if (input.topic == "node_positions" && input.age > 1 && std::isfinite(input.age)) {
          return true;
        }
      }
    }
    return false;
  }));
  CHECK(status.state == ModuleState::kRunning);
  session.signal(SIGTERM);
  CHECK(session.exit_code() == 0);
  CHECK(std::filesystem::exists(session.folder / "last.png"));
}

TEST_CASE(
    "visualizer process: a drag in the window presses with the probe, keys command the session, q "
    "closes",
    "[visualizer][system]") {
  // Oracle: geometry of the ball and the frontal camera; commands as in SessionControl.
  if (!visualizer::testing::xvfb_or_skip()) return;
  const visualizer::OffscreenDisplay display;
  Session session({});
  REQUIRE(session.play_until([&] { return session.reports(ModuleState::kReady); }));
  session.start();
  REQUIRE(session.play_until([&] { return session.reports(ModuleState::kRunning); }));
  visualizer::testing::FakeMouse mouse;
  REQUIRE(session.play_until([&] { return mouse.find_window("Palpate: scene"); }));

  const auto view = visualizer::make_layout(1280, 720).scene;
  const int x = int(view.width / 2), y = int(view.height / 2);
  const auto camera =
      visualizer::frontal_camera(Vec3::Zero(), 1.25 * 0.05, int(view.width), int(view.height));
  const double away = camera.position.norm() - 0.05;
  mouse.press(x, y, true);
  // The finger's own radius, less the depth: at first, then by the 50 pixels of the drag. The
  // ball's 320 triangles lie up to 1.5 % of its radius inside it.
  const auto height = [&] { return session.finger.norm() - 0.05; };
  const double first = visualizer::SurfacePress::kFirstDepth;
  REQUIRE(session.play_until([&] { return std::abs(height() - (0.01 - first)) < 0.015 * 0.05; }));
  CHECK(session.finger.y() < -0.04);
  const double deep = visualizer::SurfacePress::kPerDrag * 50 * camera.pixel_size(away);
  REQUIRE(session.play_until([&] {
    mouse.move(x + 40, y - 30);
    return std::abs(height() - (0.01 - first - deep)) < 0.015 * 0.05;
  }));
  mouse.release(x + 40, y - 30);
  REQUIRE(session.play_until([&] { return height() > 0.01; }));

  SessionControl command;
  const auto heard = [&](SessionCommand awaited) {
    return session.play_until([&] {
      while (session.commands.take(command)) {
        if (command.command == awaited) return true;
      }
      return false;
    });
  };
  mouse.key("space");
  CHECK(heard(SessionCommand::kPause));
  mouse.key("r");
  CHECK(heard(SessionCommand::kStart));
  CHECK(command.reset_count == 1);
  std::filesystem::remove_all(session.folder);  // a picture has nowhere to go: that is no end
  mouse.key("s");
  mouse.key("space");
  CHECK(heard(SessionCommand::kPause));
  mouse.key("q");
  CHECK(session.exit_code() == 0);
}

TEST_CASE("visualizer process: bad input ends it with one clear line", "[visualizer][fault]") {
  // Oracle: exit code 2 and the message.
  Session session({"--headless", "--frames", "scene.yaml/frames"});
  CHECK(session.exit_code() == 2);
  std::ifstream log(session.folder / "stderr.txt");
  std::string line;
  std::getline(log, line);
  CHECK(line.find("--frames 'scene.yaml/frames': must be a folder") != std::string::npos);
}
