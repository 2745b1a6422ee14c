#include "studies/paper/scene_run.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "deformation/organ_messages.h"
#include "modules/core/error.h"
#include "studies/report/table_file.h"

namespace palpate::paper {
namespace {

Vec3 node(const std::vector<float>& positions, std::uint32_t i) {
  const float* p = positions.data() + 3 * std::size_t{i};
  return {p[0], p[1], p[2]};
}

Sample sample_of(const session::InProcess& pipeline, const FarField& far_field, double time) {
  const NodePositions& nodes = pipeline.node_positions(0);
  return {time,
          nodes.volume,
          nodes.target_volume,
          nodes.pressure,
          pipeline.contact_model(0).force().norm(),
          far_field.displacement(nodes, pipeline.probe(0).pose.position)};
}

}  // namespace

FarField::FarField(const SurfaceTopology& topology) {
  const std::set<std::uint32_t> fixed(topology.fixed_nodes.begin(), topology.fixed_nodes.end());
  std::vector<Vec3> surface;
  for (std::uint32_t i = 0; i < topology.surface_node_count; ++i) {
    surface.push_back(node(topology.rest_positions, i));
    if (fixed.count(i) > 0) continue;
    nodes_.push_back(i);
    rest_.push_back(surface.back());
  }
  const Vec3 axis = geometry::dominant_axis(surface);
  const auto along = [&](const Vec3& a, const Vec3& b) { return axis.dot(a) < axis.dot(b); };
  const auto [low, high] = std::minmax_element(surface.begin(), surface.end(), along);
  distance_ = 0.5 * axis.dot(*high - *low);
}

double FarField::displacement(const NodePositions& nodes, const Vec3& p_W) const {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if ((rest_[i] - p_W).squaredNorm() < distance_ * distance_) continue;
    sum += (node(nodes.positions, nodes_[i]) - rest_[i]).norm();
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

std::vector<Sample> run_scene(const scene::Scene& scene, double seconds, report::Progress& progress,
                              const Observer& observe) {
  auto pipeline = session::load_session(scene);
  const FarField far_field(deformation::surface_message(pipeline.world(), 0));
  const double period = 1 / scene.rates.deformation;
  const auto periods = static_cast<int>(std::lround(seconds / period));
  std::vector<Sample> samples;
  for (int k = 1; k <= periods; ++k) {
    const double time = k * period;
    pipeline.run_until(time - 0.5e-9);  // the schedule counts whole nanoseconds
    samples.push_back(sample_of(pipeline, far_field, time));
    progress.at(time, seconds, "s simulated");
    if (observe && !observe(pipeline, samples.back())) break;
  }
  const ContactTroubles troubles = pipeline.contact_troubles();
  if (troubles.truncated + troubles.lost > 0) {
    throw std::runtime_error("scene " + scene.name + ": contacts were left out or lost");
  }
  return samples;
}

void write_samples(const std::vector<Sample>& samples, const std::filesystem::path& file) {
  report::TableFile table(file, {"time_s", "volume_ratio", "volume_error", "pressure_pa", "force_n",
                                 "far_displacement_m"});
  for (const Sample& s : samples) {
    table.write_row({s.time, s.volume / s.target_volume, s.volume_error(), s.pressure, s.force,
                     s.far_displacement});
  }
  table.finish();
}

std::string model_key(const std::string& model) {
  PALPATE_DEMAND(model == "implicit_volume" || model == "mass_spring");
  return model == "mass_spring" ? "mass_spring" : "implicit_volume";
}

double worst_volume_error(const std::vector<Sample>& samples) {
  double worst = 0;
  for (const Sample& s : samples) worst = std::max(worst, std::abs(s.volume_error()));
  return worst;
}

double greatest_force(const std::vector<Sample>& samples) {
  double greatest = 0;
  for (const Sample& s : samples) greatest = std::max(greatest, s.force);
  return greatest;
}

}  // namespace palpate::paper
