#include "visualizer/stage.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/output_file.h"
#include "modules/core/units.h"
#include "modules/runtime/run_stage.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"
#include "visualizer/frame_schedule.h"
#include "visualizer/offscreen_display.h"
#include "visualizer/recorder_child.h"
#include "visualizer/renderer.h"

namespace palpate::visualizer {
namespace {

constexpr double kSlowMotion = 0.25;    // of real time
constexpr double kLongestBurst = 0.04;  // of slow motion, in a picture [s]

/// Everything the visualizer hears.
struct Inputs {
  bus::Reader<SurfaceTopology> surfaces;
  bus::Reader<NodePositions> positions;
  bus::Reader<ProbeState> probes;
  bus::Reader<Contacts> contacts;
  bus::Reader<HapticForce> forces;
  bus::Reader<ContactModel> laws;
  bus::Reader<ModuleStatus> statuses;

  explicit Inputs(bus::Bus& bus)
      : surfaces(bus.reader(bus::kSurface, bus::Keep::kBacklog)),
        positions(bus.reader(bus::kNodePositions)),
        probes(bus.reader(bus::kProbeState)),
        contacts(bus.reader(bus::kContacts)),
        forces(bus.reader(bus::kHapticForce, bus::Keep::kBacklog)),
        laws(bus.reader(bus::kContactModel)),
        statuses(bus.reader(bus::kModuleStatus)) {}

  /// Surfaces first: node positions of a surface not known yet are of no use.
  void receive(SceneView& view, std::int64_t now_ns) {
    SurfaceTopology surface;
    while (surfaces.take(surface)) view.receive(std::move(surface));
    NodePositions nodes;
    while (positions.take(nodes)) view.receive(std::move(nodes), now_ns);
    ProbeState probe;
    while (probes.take(probe)) view.receive(probe);
    Contacts touching;
    while (contacts.take(touching)) view.receive(std::move(touching));
    HapticForce force;
    while (forces.take(force)) view.receive(force);
    ContactModel law;
    while (laws.take(law)) view.receive(law);
    ModuleStatus status;
    while (statuses.take(status)) view.receive(std::move(status), now_ns);
  }
};

std::vector<geometry::TriangleSurface> probe_surfaces(const scene::Scene& scene) {
  std::vector<geometry::TriangleSurface> surfaces;
  for (const scene::Probe& probe : scene.probes) {
    const auto form = scene::form_of(probe.shape, scene::load_probe_mesh(probe));
    surfaces.push_back(geometry::surface_of(form, 1.0));
  }
  return surfaces;
}

std::vector<ProbeBody> probe_bodies(const scene::Scene& scene,
                                    const std::vector<geometry::TriangleSurface>& surfaces) {
  std::vector<ProbeBody> bodies;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    ProbeBody body;
    for (const Vec3& node : surfaces[i].nodes) body.reach = std::max(body.reach, node.norm());
    body.nodes = surfaces[i].nodes;
    body.plane = std::holds_alternative<geometry::HalfSpace>(scene::form_of(scene.probes[i].shape));
    bodies.push_back(std::move(body));
  }
  return bodies;
}

/// The picture and what happens in it.
class Studio {
 public:
  Studio(const scene::Scene& scene, bool window)
      : view(scene),
        surfaces_(probe_surfaces(scene)),
        interaction(probe_bodies(scene, surfaces_)),
        renderer({.window = window, .title = "Palpate: " + scene.name}, surfaces_) {
    aim();
  }

  void draw(std::int64_t now_ns) {
    const Layout layout = make_layout(renderer.width(), renderer.height());
    interaction.camera.width = static_cast<int>(layout.scene.width);
    interaction.camera.height = static_cast<int>(layout.scene.height);
    if (!aimed_ && anything_to_see()) aim();
    view.refresh();
    const DrawList list =
        make_draw_list(view, interaction.options, interaction.camera.view_direction());
    renderer.draw(list, make_overlay(view, list, interaction, layout, now_ns), interaction.camera);
  }

  bool anything_to_see() const {
    for (const OrganView& organ : view.organs()) {
      if (organ.known) return true;
    }
    return false;
  }

  SceneView view;

 private:
  std::vector<geometry::TriangleSurface> surfaces_;

 public:
  Interaction interaction;
  Renderer renderer;

 private:
  /// The scene's camera, else all organs from the front; once they are known, not again.
  void aim() {
    aimed_ = anything_to_see();
    interaction.camera = home_camera(view, interaction.camera.width, interaction.camera.height);
  }

  bool aimed_ = false;
};

/// What was to be seen, and is not.
struct LostPictures {
  std::size_t count = 0;
  std::string first;  ///< which, and why
};

/// Draws into the window each cycle; without one only the pictures that are kept.
class VisualizerStage : public runtime::Stage {
 public:
  VisualizerStage(const scene::Scene& scene, const VisualizerOptions& options, bool window,
                  const runtime::ModuleOptions& common, bus::Bus& bus, LostPictures& lost)
      : options_(options),
        lost_(lost),
        window_(window),
        // In lockstep the launcher alone conducts: a key pressed at some moment would change the
        // bits.
        commands_(common.lockstep.empty()),
        inputs_(bus),
        controls_(bus.reader(bus::kSessionControl, bus::Keep::kBacklog)),
        probe_inputs_(bus.writer(bus::kProbeInput)),
        conductor_(bus),
        bus_(common.bus),
        schedule_(options.frame_interval),
        studio_(scene, window) {
    if (!commands_) studio_.interaction.hands_off = "In lockstep nobody but the launcher conducts.";
    if (!options.screenshot.empty())
      check_replaces_its_like(options.screenshot, "\x89PNG", "picture");
  }

  ~VisualizerStage() override {
    if (options_.screenshot.empty()) return;
    try {
      studio_.draw(last_ns_);
      keep(options_.screenshot);
    } catch (const std::exception& error) {
      spdlog::error("{}", error.what());
    }
  }

  runtime::Health cycle(const runtime::Cycle& now) override {
    last_ns_ = now.now_ns;
    listen(now.now_ns);
    const Requests requests = studio_.interaction.handle(studio_.renderer.take_events(), view());
    // A recording made in lockstep is replayed without anyone saying that it runs.
    const bool goes_on = now.running || view().sim_time() > 0;
    const bool kept = !options_.frames.empty() && goes_on && studio_.anything_to_see() &&
                      schedule_.take_due(view().sim_time());
    if (window_ || kept) studio_.draw(now.now_ns);
    if (kept) keep(options_.frames / frame_name(view().sim_time()));
    carry_out(requests, now);
    runtime::Health health;
    if (lost_.count > 0) health.guard = "pictures of --frames could not be written";
    health.finished = requests.close;
    return health;
  }

  void finish(const runtime::Cycle& end) override {
    listen(end.now_ns);
    if (!stays()) return;
    view().end();
    studio_.interaction.hands_off = "The run has ended: q closes the window.";
  }
  bool stays() const override { return window_ && options_.stays; }

 private:
  SceneView& view() { return studio_.view; }

  /// One that was asked for: without it the rest goes on, and its loss is told at the end.
  void keep(const std::filesystem::path& file) {
    try {
      studio_.renderer.write_png(file);
    } catch (const std::runtime_error& error) {
      if (lost_.count++ > 0) return;
      lost_.first = error.what();
      spdlog::error("{}", error.what());
    }
  }

  void listen(std::int64_t now_ns) {
    inputs_.receive(view(), now_ns);
    SessionControl control;
    while (controls_.take(control)) session_.apply(control);
    view().receive(session_.last_command());
  }

  void carry_out(const Requests& requests, const runtime::Cycle& now) {
    for (ProbeState wanted : requests.probe_inputs) {
      wanted.header = now.header();
      if (commands_) probe_inputs_.write(wanted);
    }
    conduct(requests, now);
    if (requests.record) toggle_recording();
    if (requests.screenshot) {
      take_picture(unused_name("palpate_" + frame_name(view().sim_time()).string()));
    }
    if (requests.end_run && commands_ && options_.ends_run) {
      conductor_.command(session_, SessionCommand::kStop);
    }
  }

  void take_picture(const std::filesystem::path& file) {
    try {
      studio_.renderer.write_png(file);
      studio_.interaction.say("Written: " + file.string());
      spdlog::info("screenshot {}", std::filesystem::absolute(file).string());
    } catch (const std::runtime_error& error) {
      studio_.interaction.say("Not written: " + file.string());
      spdlog::warn("{}", error.what());
    }
  }

  /// Pause, step, slow motion and reset.
  void conduct(const Requests& requests, const runtime::Cycle& now) {
    const bool any = requests.pause_or_resume || requests.step || requests.slow_motion;
    bool& slow = studio_.interaction.options.slow_motion;
    if (any && view().ended()) {
      studio_.interaction.say("The run has ended: q closes the window.");
    } else if (requests.pause_or_resume) {
      const bool runs = slow || (session_.phase() == runtime::SessionPhase::kRunning &&
                                 !session_.halted(now.now_ns));
      slow = false;
      conductor_.command(session_, runs ? SessionCommand::kPause : SessionCommand::kStart);
    } else if (requests.step) {
      slow = false;
      conductor_.step(session_, 1 / view().scene().rates.deformation);
    } else if (requests.slow_motion) {
      slow = !slow;
      if (!slow) conductor_.command(session_, SessionCommand::kStart);
    }
    if (requests.reset) {
      runtime::SessionState after = session_;
      after.apply(next_command(session_, SessionCommand::kReset, now.now_ns));
      conductor_.command(session_, SessionCommand::kReset);
      conductor_.command(after, SessionCommand::kStart);
    } else if (slow && !view().ended()) {
      // In short steps, one a picture: between them time stands, for less than a law takes to age.
      const double since = seconds_from_ns(now.now_ns - slow_ns_);
      conductor_.step(session_, kSlowMotion * std::clamp(since, 0.0, kLongestBurst / kSlowMotion));
    }
    slow_ns_ = now.now_ns;
  }

  void toggle_recording() {
    if (recorder_) {
      const bool whole = recorder_->end();
      const std::string file = recorder_->file().string();
      recorder_.reset();
      studio_.interaction.say(whole ? "Recorded: " + file : "Not recorded: " + file);
      spdlog::info("recording {} {}", file, whole ? "ended" : "failed");
    } else {
      const std::string stem = frame_name(view().sim_time()).stem().string();
      recorder_.emplace(program_folder() / "palpate-recorder",
                        unused_name("palpate_" + stem + ".mcap"), bus_);
      studio_.interaction.say("Recording into " + recorder_->file().string() + " until v.");
    }
    studio_.interaction.options.recording = recorder_.has_value();
  }

  VisualizerOptions options_;
  LostPictures& lost_;
  bool window_, commands_;
  Inputs inputs_;
  bus::Reader<SessionControl> controls_;
  bus::Writer<ProbeState> probe_inputs_;
  runtime::SessionConductor conductor_;
  runtime::SessionState session_;
  bus::BusOptions bus_;
  std::optional<RecorderChild> recorder_;
  FrameSchedule schedule_;
  Studio studio_;
  std::int64_t slow_ns_ = 0;  // of the last cycle
  std::int64_t last_ns_ = 0;
};

}  // namespace

void run_visualizer(const runtime::ModuleOptions& common, const VisualizerOptions& options) {
  const scene::Scene scene = scene::load_scene(common.scene);
  if (!options.frames.empty()) make_writable_folder(options.frames, "--frames");
  const XConnection connection =
      options.headless ? XConnection(nullptr, [](void*) {}) : connect_to_display();
  const bool window = connection != nullptr;  // held: see connect_to_display()
  if (!window && !options.headless) spdlog::info("no display: drawing without a window");
  std::optional<OffscreenDisplay> display;
  if (!window) {
    draw_with_one_thread();
    display.emplace();
  }
  LostPictures lost;
  runtime::run_stage(
      common, scene, "visualizer", runtime::Priority::kBackground, [&](bus::Bus& bus) {
        return std::make_unique<VisualizerStage>(scene, options, window, common, bus, lost);
      });
  if (lost.count == 0) return;
  throw std::runtime_error(std::to_string(lost.count) +
                           (lost.count == 1 ? " picture is missing: " : " pictures are missing: ") +
                           lost.first);
}

}  // namespace palpate::visualizer
