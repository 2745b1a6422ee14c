#include "visualizer/visualizer_process.h"

#include <spdlog/spdlog.h>

#include <optional>

#include "modules/core/error.h"
#include "modules/runtime/module.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"
#include "visualizer/frame_schedule.h"
#include "visualizer/offscreen_display.h"
#include "visualizer/probe_shape.h"
#include "visualizer/renderer.h"

namespace palpate::visualizer {
namespace {

constexpr double kMarginAroundOrgans = 1.25;

/// Everything the visualizer hears.
struct Inputs {
  bus::Reader<SurfaceTopology> surfaces;
  bus::Reader<NodePositions> positions;
  bus::Reader<ProbeState> probes;
  bus::Reader<Contacts> contacts;
  bus::Reader<HapticForce> forces;
  bus::Reader<ModuleStatus> statuses;

  explicit Inputs(runtime::Module& module)
      : surfaces(module.bus().reader(bus::kSurface)),
        positions(module.bus().reader(bus::kNodePositions)),
        probes(module.bus().reader(bus::kProbeState)),
        contacts(module.bus().reader(bus::kContacts)),
        forces(module.bus().reader(bus::kHapticForce)),
        statuses(module.bus().reader(bus::kModuleStatus)) {
    module.watch(bus::kNodePositions, positions);
    module.watch(bus::kProbeState, probes);
    module.watch(bus::kContacts, contacts);
    module.watch(bus::kHapticForce, forces);
  }

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
    ModuleStatus status;
    while (statuses.take(status)) view.receive(std::move(status), now_ns);
  }
};

std::vector<geometry::TriangleSurface> probe_surfaces(const scene::Scene& scene) {
  std::vector<geometry::TriangleSurface> surfaces;
  for (const scene::Probe& probe : scene.probes) {
    surfaces.push_back(probe_surface(probe.shape, 1.0, scene::load_probe_mesh(probe)));
  }
  return surfaces;
}

std::vector<double> reaches_of(const std::vector<geometry::TriangleSurface>& surfaces) {
  std::vector<double> reaches;
  for (const auto& surface : surfaces) reaches.push_back(reach(surface));
  return reaches;
}

/// The picture and what happens in it.
class Stage {
 public:
  Stage(const scene::Scene& scene, bool window)
      : view(scene),
        surfaces_(probe_surfaces(scene)),
        interaction(reaches_of(surfaces_)),
        renderer({.window = window, .title = "Palpate: " + scene.name}, surfaces_) {
    aim();
  }

  void draw(std::int64_t now_ns) {
    const Layout layout = make_layout(renderer.width(), renderer.height());
    interaction.camera.width = static_cast<int>(layout.scene.width);
    interaction.camera.height = static_cast<int>(layout.scene.height);
    if (!aimed_ && anything_to_see()) aim();
    view.refresh();
    const DrawList list = make_draw_list(view, interaction.options);
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
    const Camera& old = interaction.camera;
    const double radius = kMarginAroundOrgans * view.radius();
    Camera camera = frontal_camera(view.center(), radius, old.width, old.height);
    const auto& wanted = view.scene().camera;
    if (wanted.target) camera.target = *wanted.target;
    if (wanted.position) camera.position = *wanted.position;
    interaction.camera = camera;
  }

  bool aimed_ = false;
};

void carry_out(const Requests& requests, runtime::Module& module, Stage& stage,
               runtime::SessionConductor& conductor, bus::Writer<ProbeState>& probe_inputs) {
  const runtime::SessionState& state = module.session().state();
  if (requests.probe_input) {
    ProbeState wanted = *requests.probe_input;
    wanted.header = module.header();
    probe_inputs.write(wanted);
  }
  if (requests.pause_or_resume) {
    conductor.command(state, state.phase() == runtime::SessionPhase::kRunning
                                 ? SessionCommand::kPause
                                 : SessionCommand::kStart);
  }
  if (requests.reset) {
    runtime::SessionState after = state;
    after.apply(next_command(state, SessionCommand::kReset, module.now_ns()));
    conductor.command(state, SessionCommand::kReset);
    conductor.command(after, SessionCommand::kStart);
  }
  if (requests.screenshot) {
    const std::filesystem::path file = "palpate_" + frame_name(stage.view.sim_time()).string();
    stage.renderer.write_png(file);
    spdlog::info("screenshot {}", std::filesystem::absolute(file).string());
  }
}

/// Draws into the window each cycle; without one only the pictures that are kept.
void show(runtime::Module& module, Stage& stage, const VisualizerOptions& options, bool window) {
  Inputs inputs(module);
  auto probe_inputs = module.bus().writer(bus::kProbeInput);
  runtime::SessionConductor conductor(module.bus());
  FrameSchedule schedule(options.frame_interval);
  module.ready();

  while (module.next_cycle()) {
    inputs.receive(stage.view, module.now_ns());
    stage.view.receive(module.session().state().last_command());
    const Requests requests = stage.interaction.handle(stage.renderer.take_events(), stage.view);
    const bool keep = !options.frames.empty() && module.running() && stage.anything_to_see() &&
                      schedule.take_due(stage.view.sim_time());
    if (window || keep) stage.draw(module.now_ns());
    if (keep) {
      stage.renderer.write_png(options.frames / frame_name(stage.view.sim_time()));
    }
    carry_out(requests, module, stage, conductor, probe_inputs);
    if (requests.close) break;
  }
  if (!options.screenshot.empty()) {
    stage.draw(module.now_ns());
    stage.renderer.write_png(options.screenshot);
  }
}

}  // namespace

void run_visualizer(const runtime::ModuleOptions& common, const VisualizerOptions& options) {
  const scene::Scene scene = scene::load_scene(common.scene);
  if (!options.frames.empty()) {
    std::error_code error;
    std::filesystem::create_directories(options.frames, error);
    if (error) {
      throw InputError("--frames '" + options.frames.string() + "': must be a folder that can be " +
                       "written (" + error.message() + ")");
    }
  }
  const bool window = !options.headless && display_works();
  if (!window && !options.headless) spdlog::info("no display: drawing without a window");
  std::optional<OffscreenDisplay> display;
  if (!window) {
    draw_with_one_thread();
    display.emplace();
  }
  runtime::Module module(common, scene, "visualizer", scene.rates.visualizer,
                         runtime::Priority::kBackground);
  Stage stage(scene, window);
  show(module, stage, options, window);
}

}  // namespace palpate::visualizer
