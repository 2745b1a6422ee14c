#include <chrono>
#include <optional>
#include <variant>

#include "deformation/organ_messages.h"
#include "modules/scene/scene_reader.h"
#include "studies/paper/figures.h"
#include "studies/paper/scene_run.h"
#include "studies/paper/shape_files.h"
#include "studies/report/measures.h"
#include "studies/report/table_file.h"

namespace palpate::paper {
namespace {

constexpr double kQuickSlide = 6;  // [s]: first contact, the first rest and some sliding

/// Ends of the probe's rests [s].
std::vector<double> rests_of(const scene::Probe& probe) {
  std::vector<double> ends;
  double time = 0;
  for (const auto& move : std::get<scene::ScriptedDevice>(probe.device).moves) {
    time += move.duration;
    if (!move.to) ends.push_back(time);
  }
  return ends;
}

/// Keeps the shape at first contact, at the end of each rest, and at the end.
class Moments {
 public:
  Moments(const FigureOptions& options, std::vector<double> rests)
      : options_(options),
        rests_(std::move(rests)),
        table_(options.out / "figure4_moments.csv",
               {"moment", "time_s", "probe_x_m", "probe_y_m", "probe_z_m", "probe_radius_m"}) {}

  void watch(const session::InProcess& pipeline, const Sample& sample, double probe_radius) {
    if (first_contact_ == 0 && sample.force > 0) {
      first_contact_ = sample.time;
      keep("first_contact", pipeline, sample, probe_radius);
    }
    if (next_ < rests_.size() && sample.time >= rests_[next_] - 1e-9) {
      ++next_;
      keep("pressed_" + std::to_string(next_), pipeline, sample, probe_radius);
    }
  }
  void finish() { table_.finish(); }
  double first_contact() const { return first_contact_; }  ///< 0: there was none [s]

 private:
  void keep(const std::string& moment, const session::InProcess& pipeline, const Sample& sample,
            double probe_radius) {
    write_nodes(deformation::surface_message(pipeline.world(), 0),
                pipeline.node_positions(0).positions, options_.out, "figure4_" + moment);
    const Vec3& p = pipeline.probe(0).pose.position;
    table_.write_row({moment, report::text_of("%.3f", sample.time), report::text_of("%.6f", p.x()),
                      report::text_of("%.6f", p.y()), report::text_of("%.6f", p.z()),
                      report::text_of("%.6f", probe_radius)});
  }

  const FigureOptions& options_;
  std::vector<double> rests_;
  report::TableFile table_;
  std::size_t next_ = 0;
  double first_contact_ = 0;
};

double greatest_far_displacement(const std::vector<Sample>& samples) {
  double greatest = 0;
  for (const Sample& s : samples) greatest = std::max(greatest, s.far_displacement);
  return greatest;
}

Findings findings_of(const std::vector<Sample>& samples, const Moments& moments, double wanted) {
  const double came = samples.empty() ? 0 : samples.back().time;
  Findings findings;
  const auto add = [&](const std::string& quantity, const std::string& measured) {
    findings.push_back({"Figure 4", quantity, "", measured});
  };
  const bool cut = came < wanted - 1e-6;
  add("simulated [s]",
      report::text_of("%.2f", came) +
          (cut ? report::text_of(" of %.0f: cut short by --budget-s", wanted) : ""));
  add("first contact [s]", report::text_of("%.2f", moments.first_contact()));
  add("greatest force [N]", report::text_of("%.3f", greatest_force(samples)));
  add("|V-V0|/V0 largest", report::text_of("%.2e", worst_volume_error(samples)));
  add("mean far-field displacement, largest [mm]",
      report::text_of("%.3f", 1e3 * greatest_far_displacement(samples)));
  return findings;
}

scene::Scene slide_scene(const FigureOptions& options) {
  auto scene = scene::load_scene(options.scenes / "stomach_probe_refined.yaml");
  if (options.quick) {
    scene.organs[0].mesh = scene::load_scene(options.scenes / "stomach_probe.yaml").organs[0].mesh;
  }
  return scene;
}

}  // namespace

Findings make_slide_figure(const FigureOptions& options, report::Progress& progress) {
  const auto scene = slide_scene(options);
  const double wanted = options.quick ? kQuickSlide : scene.duration;
  const double radius = std::get<scene::SphereShape>(scene.probes[0].shape).radius;
  progress.begin("Figure 4: probe slides through the refined stomach");
  Moments moments(options, rests_of(scene.probes[0]));
  std::optional<SurfaceTopology> topology;
  const auto start = std::chrono::steady_clock::now();
  double wall = 0;
  const auto samples = run_scene(scene, wanted, progress, [&](const auto& pipeline, const auto& s) {
    if (!topology) topology = deformation::surface_message(pipeline.world(), 0);
    moments.watch(pipeline, s, radius);
    wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return wall < options.budget;
  });
  moments.finish();
  write_topology(*topology, options.out, "figure4", /*springs=*/false);
  write_samples(samples, options.out / "figure4.csv");

  auto findings = findings_of(samples, moments, wanted);
  const std::string nodes = std::to_string(topology->surface_node_count) + " surface nodes, " +
                            std::to_string(topology->triangles.size()) + " triangles";
  findings.insert(findings.begin(),
                  {"Figure 4", "mesh", "over 19K nodes, 39K triangles",
                   nodes + (options.quick ? " (--quick: not the refined stomach)" : "")});
  findings.push_back({"Figure 4", "real-time factor, loading included", "",
                      report::text_of("%.3f", samples.back().time / wall)});
  return findings;
}

}  // namespace palpate::paper
