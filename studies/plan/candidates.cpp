#include "studies/plan/candidates.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "deformation/models.h"
#include "modules/scene/assets.h"
#include "modules/scene/models.h"
#include "modules/scene/schema.h"
#include "studies/chart/fidelity.h"

namespace palpate::plan {
namespace {

constexpr std::size_t kLeastNodes = 60, kMostNodes = 20000;
constexpr double kReferenceRate = 500;  // [Hz]

/// Longest edge at a touched place in radii, and its growth with the distance.
struct Rung {
  double edge, growth;
};
constexpr std::array kLinear{Rung{1, 1}, Rung{0.5, 0.7}, Rung{0.5, 0.5}, Rung{1.0 / 3, 0.35}};
constexpr std::array kQuadratic{Rung{1.4, 1}, Rung{1, 1}, Rung{0.7, 1}};

/// None: a model that is not refined where it is touched.
std::span<const Rung> rungs_of(const std::string& model) {
  if (model == "nodal_pressure") return kLinear;
  if (model == "quadratic_pressure") return kQuadratic;
  return {};
}

std::vector<std::string> models_for(scene::Needs::Contents contents) {
  const bool fluid = contents == scene::Needs::Contents::kFluid;
  std::vector<std::string> models;
  for (const deformation::ModelRow& row : deformation::model_rows()) {
    if (fluid ? row.stands_for_fluid : row.stands_for_solid) models.emplace_back(row.word);
  }
  return models;
}

std::size_t nodes_of(const scene::Scene& scene) {
  return scene::load_organ(
             scene_with(scene, {"implicit_volume", scene.organs[0].mesh.nodes, 100}).organs[0])
      .surface.nodes.size();
}

}  // namespace

std::string Candidate::name() const {
  auto text =
      fmt::format("{}, {} nodes, {:g} Hz{}", model, nodes, rate,
                  integrator == scene::Integrator::kBackwardEuler ? ", backward_euler" : "");
  if (refine.any()) {
    text += fmt::format(", {:.3g} mm + {:.2g} d",
                        1e3 * refine.edge_length.value_or(scene::Refinement::kRegionEdge),
                        refine.growth.value_or(scene::Refinement::kGrowth));
  }
  if (refine.follow) text += " following";
  return text;
}

Candidate reference_of(const scene::Scene& scene) {
  return {"implicit_volume", std::min(4 * nodes_of(scene), kMostNodes), kReferenceRate,
          scene::Integrator::kSymplecticEuler};
}

std::vector<Candidate> candidates_of(const scene::Scene& scene,
                                     const std::vector<scene::Region>& touched, double radius) {
  const std::size_t nodes = nodes_of(scene);
  const double least = scene.needs.step_rate;
  std::vector<Candidate> candidates;
  for (const std::string& model : models_for(scene.needs.contents)) {
    for (std::size_t count : {nodes / 4, nodes / 2, nodes, 2 * nodes}) {
      // Of a quadratic mesh these are corners: a quarter of them makes as many nodes.
      if (scene::is_quadratic(model)) count /= 4;
      for (const double rate : {least, 2 * least}) {
        if (count < kLeastNodes || count > kMostNodes || rate > 2000) continue;
        candidates.push_back({model, count, rate});
      }
      if (touched.empty() || count > nodes || count < kLeastNodes) continue;
      for (const auto& [edge, growth] : rungs_of(model)) {
        constexpr auto kIntegrator = scene::Integrator::kAutomatic;
        candidates.push_back({model, count, least, kIntegrator, {touched, edge * radius, growth}});
        candidates.push_back({model, count, least, kIntegrator, {{}, edge * radius, growth, true}});
      }
    }
  }
  return candidates;
}

double weight_of(const Candidate& candidate, double radius) {
  const auto& format = scene::format_of(candidate.model);
  const bool is_quadratic = scene::is_quadratic(candidate.model);
  double nodes = static_cast<double>(candidate.nodes) * (is_quadratic ? 4 : 1);
  if (candidate.refine.any()) {
    const double edge = candidate.refine.edge_length.value_or(scene::Refinement::kRegionEdge);
    const double growth = candidate.refine.growth.value_or(scene::Refinement::kGrowth);
    nodes += (is_quadratic ? 2400 : 300) * std::pow(radius / edge, 1.5) * std::pow(growth, -1.2);
  }
  // Those of tetrahedra that need no solver take many small steps.
  const double model = !format.is_solid() ? 0.1 : format.iterations == 1 ? 10 : 1;
  return model * nodes * candidate.rate;
}

scene::Scene scene_with(const scene::Scene& scene, const Candidate& candidate, std::size_t number) {
  scene::Scene changed = scene;
  scene::Organ& organ = changed.organs[number];
  organ.model = candidate.model;
  organ.integrator = candidate.integrator;
  organ.iterations = 0;
  scene::drop_ignored_keys(organ);
  organ.solid.poisson_ratio =
      chart::unlocked_poisson_ratio(candidate.model, organ.solid.poisson_ratio);
  organ.mesh.nodes = candidate.nodes;
  organ.solid.refine = candidate.refine;
  if (candidate.rate > 0) changed.rates.deformation = candidate.rate;
  changed.rates.collision = std::max(changed.rates.collision, changed.rates.deformation);
  changed.rates.haptics = std::max(changed.rates.haptics, changed.needs.haptics_rate);
  return changed;
}

}  // namespace palpate::plan
