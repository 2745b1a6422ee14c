#include <sched.h>

#include <array>
#include <chrono>
#include <ctime>

#include "deformation/organ_messages.h"
#include "modules/core/units.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"
#include "palpate/session/in_process.h"
#include "studies/paper/figures.h"
#include "studies/report/measures.h"
#include "studies/report/table_file.h"
#include "visualizer/offscreen_display.h"
#include "visualizer/renderer.h"

namespace palpate::paper {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kFramesPerSecond = 30;  // of simulated time
constexpr int kQuickFrames = 60;

/// What is drawn. The paper does not say how large its pictures were; its figures show the organ
/// and the probe alone.
struct View {
  const char* name;
  const char* text;
  int width, height;  // [pixels]
  bool panels;        // with plots and table, as the visualizer shows them
};
constexpr std::array<View, 2> kViews{
    {{"organ", "organ and probe, 640 x 480", 640, 480, false},
     {"window", "the visualizer's whole window, 1280 x 720", 1280, 720, true}}};

constexpr double kMarginAroundOrgans = 1.25;

/// While one exists, this thread and what it starts run on the core it was on.
class OneCore {
 public:
  OneCore() {
    sched_getaffinity(0, sizeof earlier_, &earlier_);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    sched_setaffinity(0, sizeof one, &one);
  }
  ~OneCore() { sched_setaffinity(0, sizeof earlier_, &earlier_); }
  OneCore(const OneCore&) = delete;
  OneCore& operator=(const OneCore&) = delete;

 private:
  cpu_set_t earlier_{};
};

std::vector<geometry::TriangleSurface> probe_surfaces(const scene::Scene& scene) {
  std::vector<geometry::TriangleSurface> surfaces;
  for (const auto& probe : scene.probes) {
    const auto form = scene::form_of(probe.shape, scene::load_probe_mesh(probe));
    surfaces.push_back(geometry::surface_of(form, 1.0));
  }
  return surfaces;
}

/// The picture the visualizer shows, drawn from a pipeline instead of from topics. A window of its
/// own, so that it is drawn the way a person sees it.
class Picture {
 public:
  Picture(const scene::Scene& scene, const View& how)
      : how_(how),
        view_(scene),
        interaction_(std::vector<visualizer::ProbeBody>(scene.probes.size())),
        renderer_({how.width, how.height, /*window=*/true}, probe_surfaces(scene)) {}

  void draw(const session::InProcess& pipeline, bool first) {
    const auto now = std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
    if (first) view_.receive(deformation::surface_message(pipeline.world(), 0));
    view_.receive(pipeline.node_positions(0), now);
    view_.receive(pipeline.probe(0));
    view_.receive(pipeline.contacts(0));
    view_.receive(pipeline.haptic_force(0));
    view_.refresh();
    const auto layout = visualizer::make_layout(how_.width, how_.height);
    if (first)
      aim(how_.panels ? layout.scene
                      : visualizer::Box2{0, 0, double(how_.width), double(how_.height)});
    const auto list = visualizer::make_draw_list(view_, interaction_.options);
    visualizer::Overlay flat;
    if (how_.panels) flat = visualizer::make_overlay(view_, list, interaction_, layout, now);
    renderer_.draw(list, flat, interaction_.camera);
  }

 private:
  void aim(const visualizer::Box2& box) {
    auto& camera = interaction_.camera;
    camera = visualizer::frontal_camera(view_.center(), kMarginAroundOrgans * view_.radius(),
                                        static_cast<int>(box.width), static_cast<int>(box.height));
    const auto& wanted = view_.scene().camera;
    camera.target = wanted.target.value_or(camera.target);
    camera.position = wanted.position.value_or(camera.position);
  }

  const View& how_;
  visualizer::SceneView view_;
  visualizer::Interaction interaction_;
  visualizer::Renderer renderer_;
};

double seconds_between(Clock::time_point a, Clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

struct Frames {
  std::vector<double> simulate, draw;  ///< [s]
  double core_share = 0;               ///< processor time over wall time
  double mean_rate() const {
    double sum = 0;
    for (std::size_t i = 0; i < draw.size(); ++i) sum += simulate[i] + draw[i];
    return static_cast<double>(draw.size()) / sum;
  }
};

Frames run_frames(const scene::Scene& scene, int count, Picture& picture,
                  report::Progress& progress) {
  auto pipeline = session::load_session(scene);
  Frames frames;
  picture.draw(pipeline, /*first=*/true);
  const auto start = Clock::now();
  const std::clock_t used = std::clock();
  for (int k = 1; k <= count; ++k) {
    const auto begin = Clock::now();
    pipeline.run_until(k / kFramesPerSecond);
    const auto simulated = Clock::now();
    picture.draw(pipeline, /*first=*/false);
    frames.simulate.push_back(seconds_between(begin, simulated));
    frames.draw.push_back(seconds_between(simulated, Clock::now()));
    progress.at(k, count, "frames");
  }
  frames.core_share =
      double(std::clock() - used) / CLOCKS_PER_SEC / seconds_between(start, Clock::now());
  return frames;
}

void write_frames(const Frames& frames, const std::filesystem::path& file) {
  report::TableFile table(file, {"frame", "simulate_s", "draw_s"});
  for (std::size_t i = 0; i < frames.draw.size(); ++i) {
    table.write_row({double(i), frames.simulate[i], frames.draw[i]});
  }
  table.finish();
}

void add_findings(const Frames& frames, const View& how, double haptic_rate, Findings& findings) {
  const double rate = frames.mean_rate();
  const auto add = [&](const std::string& quantity, const std::string& paper,
                       const std::string& measured) {
    findings.push_back({"Speed", quantity, paper, measured});
  };
  add(std::string("frames/s: ") + how.text, ">= 40 at 550 nodes; 30 at least",
      report::text_of("%.1f", rate));
  add("  simulate and collide 1/30 s, report::median [ms]", "",
      report::text_of("%.2f", 1e3 * report::median(frames.simulate)));
  add("  draw in software, report::median [ms]", "",
      report::text_of("%.2f", 1e3 * report::median(frames.draw)));
  add("  of the core this program had [%]", "", report::text_of("%.0f", 100 * frames.core_share));
  add("  haptic updates per wall second beside it", "500 at least",
      report::text_of("%.0f", rate / kFramesPerSecond * haptic_rate));
}

}  // namespace

Findings measure_frame_rate(const FigureOptions& options, report::Progress& progress) {
  const auto scene = scene::load_scene(options.scenes / "stomach_probe.yaml");
  const int count =
      options.quick ? kQuickFrames : static_cast<int>(scene.duration * kFramesPerSecond);
  const OneCore one_core;
  visualizer::draw_with_one_thread();
  const visualizer::OffscreenDisplay display;
  Findings findings{{"Speed", "machine", "Pentium 4, 3 GHz",
                     report::machine_name() + "; one used, no graphics card"}};
  for (const View& how : kViews) {
    progress.begin(std::string("Speed: one core simulates, collides and draws ") + how.text);
    Picture picture(scene, how);
    const Frames frames = run_frames(scene, count, picture, progress);
    write_frames(frames, options.out / (std::string("frame_rate_") + how.name + ".csv"));
    add_findings(frames, how, scene.rates.haptics, findings);
  }
  return findings;
}

}  // namespace palpate::paper
