#include "studies/stability/subject.h"

#include <algorithm>
#include <cmath>

#include "deformation/volume/rules/baumgarte.h"
#include "deformation/volume/rules/bourguignon_cani.h"
#include "deformation/volume/rules/penalty.h"
#include "modules/core/error.h"
#include "modules/geometry/primitives.h"
#include "modules/geometry/tools/gmsh_tool.h"

namespace palpate::stability {
namespace {

using scene::Integrator;
using scene::Model;

constexpr double kPeriod = 4e-3;        // [s]; chooses no integrator here
constexpr double kPoissonRatio = 0.45;  // of the solid ball
constexpr int kLevels = 2;

/// Whether a step is symplectic Euler of the springs, so that their frequencies end it.
bool is_explicit(const Subject& subject) {
  return subject.model != Model::kChainMail && !scene::is_solid(subject.model) &&
         subject.model != Model::kXpbdSprings && subject.integrator == Integrator::kSymplecticEuler;
}

Contents contents_of(const Subject& subject, const deformation::OrganModel& model) {
  switch (subject.model) {
    case Model::kMassSpring:
      return {};
    case Model::kPenalty:
      return {false, deformation::kPenaltyModulus / model.rest_volume};
    case Model::kBourguignonCani:  // on a ball, a penalty of this modulus
      return {false, deformation::BourguignonCani::kModulus / model.rest_volume};
    default:
      return {true, 0};
  }
}

/// With tetrahedra as large as its triangles.
geometry::OrganShape filled_ball(int levels) {
  const auto surface = geometry::make_ball(kRadius, levels);
  const auto edges = geometry::edges_of(surface.triangles);
  double sum = 0;
  for (const auto& [a, b] : edges) sum += (surface.nodes[a] - surface.nodes[b]).norm();
  return geometry::shape_of(
      geometry::fill_surface(surface, sum / static_cast<double>(edges.size())));
}

/// Of Φ̈ + 2a Φ̇ + b² Φ = 0 alone, whatever the springs: b² h² + 4 a h = 4.
double baumgarte_step() {
  constexpr double a = deformation::Baumgarte::kA, b = deformation::Baumgarte::kB;
  return 2 * (std::sqrt(a * a + b * b) - a) / (b * b);
}

}  // namespace

const std::vector<Subject>& subjects() {
  constexpr auto kExplicit = Integrator::kSymplecticEuler, kImplicit = Integrator::kBackwardEuler,
                 kOwn = Integrator::kAutomatic;
  static const std::vector<Subject> kAll{
      {"mass_spring", Model::kMassSpring, kExplicit, true, false},
      {"implicit_volume", Model::kImplicitVolume, kExplicit, true, true},
      {"mass_spring_backward", Model::kMassSpring, kImplicit, false, false},
      {"implicit_volume_backward", Model::kImplicitVolume, kImplicit, true, true},
      {"penalty", Model::kPenalty, kExplicit, false, true},
      {"baumgarte", Model::kBaumgarte, kExplicit, false, true},
      {"promayon", Model::kPromayon, kExplicit, false, true},
      {"post_stabilisation", Model::kPostStabilisation, kExplicit, false, true},
      {"bourguignon_cani", Model::kBourguignonCani, kExplicit, false, true},
      {"zordan", Model::kZordan, kExplicit, false, true},
      {"element_volume", Model::kElementVolume, kExplicit, false, true},
      {"xpbd_springs", Model::kXpbdSprings, kOwn, true, true},
      {"xpbd_tetrahedra", Model::kXpbdTetrahedra, kOwn, false, false},
      {"corotational", Model::kCorotational, kOwn, true, false},
      {"nodal_pressure", Model::kNodalPressure, kOwn, false, false},
      {"quadratic_elements", Model::kQuadraticElements, kOwn, false, false},
      {"modal", Model::kModal, kOwn, false, false},
      {"chainmail", Model::kChainMail, kOwn, false, false}};
  return kAll;
}

const Subject& subject_named(const std::string& name) {
  const auto& all = subjects();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Subject& s) { return name == s.name; });
  PALPATE_DEMAND(found != all.end());
  return *found;
}

scene::Organ organ_of(const Subject& subject, double youngs_modulus) {
  scene::Organ organ;
  organ.name = "ball";
  organ.model = subject.model;
  organ.integrator = subject.integrator;
  organ.tissue.youngs_modulus = youngs_modulus;
  organ.tissue.damping_ratio = organ.tissue.drag = 0;
  organ.solid.poisson_ratio = kPoissonRatio;
  return organ;
}

const geometry::OrganShape& Shapes::shape_for(const Subject& subject) {
  const bool solid = scene::is_solid(subject.model);
  auto& shape = subject.model == Model::kModal               ? modal_
                : subject.model == Model::kQuadraticElements ? quadratic_
                : solid                                      ? solid_
                                                             : surface_;
  if (shape) return *shape;
  if (!solid) return shape.emplace(geometry::make_ball(kRadius, kLevels));
  shape = filled_ball(&shape == &modal_ ? 1 : &shape == &quadratic_ ? 0 : kLevels);
  if (scene::is_quadratic(subject.model)) shape = geometry::with_edge_nodes(*shape);
  return *shape;
}

geometry::OrganShape ball_with_sliver(double ratio) {
  PALPATE_DEMAND(ratio >= 4);
  geometry::TriangleSurface surface = geometry::make_ball(kRadius, kLevels);
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

Specimen::Specimen(const scene::Organ& organ, const geometry::OrganShape& shape)
    : model_(std::make_unique<const deformation::OrganModel>(
          deformation::build_organ_model(organ, Vec3::Zero(), shape))),
      dynamics_(deformation::make_dynamics(organ, *model_, kPeriod)),
      state_(deformation::rest_state(*model_)) {}

double Specimen::mass() const {
  double sum = 0;
  for (const double mass : model_->masses) sum += mass;
  return sum;
}

Prediction predict(const Subject& subject, Specimen& specimen) {
  Prediction prediction;
  prediction.given = specimen.dynamics().largest_step();
  const bool pyramids = subject.model == Model::kZordan || subject.model == Model::kElementVolume;
  if (!is_explicit(subject) || pyramids) return prediction;
  prediction.value = predicted_step(specimen.model(), specimen.state().positions,
                                    contents_of(subject, specimen.model()));
  if (subject.model == Model::kBaumgarte) {
    prediction.value = std::min(prediction.value, baumgarte_step());
  }
  prediction.exact = true;
  return prediction;
}

}  // namespace palpate::stability
