#include "studies/stability/scheme.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "deformation/volume/rules/baumgarte.h"
#include "deformation/volume/rules/bourguignon_cani.h"
#include "deformation/volume/rules/penalty.h"
#include "modules/core/error.h"
#include "modules/geometry/primitives.h"
#include "modules/scene/models.h"

namespace palpate::stability {
namespace {

using scene::Integrator;

constexpr double kPoissonRatio = 0.45;  // of the solid ball
constexpr int kLevels = 2;

/// Whether a step is symplectic Euler of the springs, so that their frequencies end it.
bool is_explicit(const Scheme& scheme) {
  return scheme.model != "chainmail" && !scene::is_solid(scheme.model) &&
         scheme.model != "xpbd_springs" && scheme.integrator == Integrator::kSymplecticEuler;
}

Contents contents_of(const Scheme& scheme, const deformation::OrganModel& model) {
  if (scheme.model == "mass_spring") return {};
  if (scheme.model == "penalty") return {false, deformation::kPenaltyModulus / model.rest_volume};
  if (scheme.model == "bourguignon_cani") {  // on a ball, a penalty of this modulus
    return {false, deformation::BourguignonCani::kModulus / model.rest_volume};
  }
  return {true, 0};
}

/// Of Φ̈ + 2a Φ̇ + b² Φ = 0 alone, whatever the springs: b² h² + 4 a h = 4.
double baumgarte_step() {
  constexpr double a = deformation::Baumgarte::kA, b = deformation::Baumgarte::kB;
  return 2 * (std::sqrt(a * a + b * b) - a) / (b * b);
}

}  // namespace

const std::vector<Scheme>& schemes() {
  static const std::vector<Scheme> kAll = [] {
    const std::set<std::string> quick{"mass_spring", "implicit_volume", "implicit_volume_backward",
                                      "xpbd_springs", "corotational"};
    std::vector<Scheme> all;
    const auto add = [&](const deformation::ModelRow& row, const char* suffix, Integrator by) {
      const std::string name = std::string(row.word) + suffix;
      all.push_back({name, row.word, by, quick.count(name) > 0,
                     row.volume != deformation::VolumeKeeping::kNone});
    };
    for (const deformation::ModelRow& row : deformation::model_rows()) {
      const scene::ModelFormat& format = scene::format_of(row.word);
      const bool iterates = format.iterations > 0 || format.is_solid();
      add(row, "", iterates ? Integrator::kAutomatic : Integrator::kSymplecticEuler);
      if (format.has_integrator) add(row, "_backward", Integrator::kBackwardEuler);
    }
    return all;
  }();
  return kAll;
}

const Scheme& scheme_named(const std::string& name) {
  const auto& all = schemes();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Scheme& s) { return name == s.name; });
  PALPATE_DEMAND(found != all.end());
  return *found;
}

scene::Organ organ_of(const Scheme& scheme, double youngs_modulus) {
  scene::Organ organ;
  organ.name = "ball";
  organ.model = scheme.model;
  organ.integrator = scheme.integrator;
  organ.tissue.youngs_modulus = youngs_modulus;
  organ.tissue.damping_ratio = organ.tissue.drag = 0;
  organ.solid.poisson_ratio = kPoissonRatio;
  return organ;
}

const geometry::OrganShape& Shapes::shape_for(const Scheme& scheme) {
  const bool solid = scene::is_solid(scheme.model);
  const bool quadratic = scene::is_quadratic(scheme.model);
  auto& shape = scheme.model == "quadratic_elements" ? quadratic_
                : quadratic                          ? modal_
                : solid                              ? solid_
                                                     : surface_;
  if (shape) return *shape;
  if (!solid) return shape.emplace(geometry::make_ball(kBallRadius, kLevels));
  shape = rigs::filled_ball(&shape == &modal_ ? 1 : &shape == &quadratic_ ? 0 : kLevels);
  if (quadratic) shape = geometry::with_edge_nodes(*shape);
  return *shape;
}

geometry::OrganShape ball_with_sliver(double ratio) {
  PALPATE_DEMAND(ratio >= 4);
  geometry::TriangleSurface surface = geometry::make_ball(kBallRadius, kLevels);
  const auto [a, b, c] = surface.triangles[0];
  const Vec3 middle = (surface.nodes[a] + surface.nodes[b]) / 2;
  const Vec3 edge = surface.nodes[b] - surface.nodes[a], side = surface.nodes[c] - middle;
  const Vec3 inward = (side - side.dot(edge) / edge.squaredNorm() * edge).normalized();
  const double height = edge.norm() / ratio;
  const auto apex = static_cast<std::uint32_t>(surface.nodes.size()), core = apex + 1;
  surface.nodes.push_back(middle + height * inward);
  surface.nodes.push_back(middle + height / 3 * inward);
  surface.triangles[0] = {b, c, apex};
  surface.triangles.push_back({c, a, apex});
  surface.triangles.push_back({a, b, core});
  surface.triangles.push_back({b, apex, core});
  surface.triangles.push_back({apex, a, core});
  return surface;
}

Prediction predict(const Scheme& scheme, TestBody& body) {
  Prediction prediction;
  prediction.given = body.dynamics().largest_step();
  const bool pyramids = scheme.model == "zordan" || scheme.model == "element_volume";
  if (!is_explicit(scheme) || pyramids) return prediction;
  prediction.value =
      predicted_step(body.model(), body.state().positions, contents_of(scheme, body.model()));
  if (scheme.model == "baumgarte") {
    prediction.value = std::min(prediction.value, baumgarte_step());
  }
  prediction.exact = true;
  return prediction;
}

}  // namespace palpate::stability
