#include "studies/chart/fidelity.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "modules/scene/schema.h"

namespace palpate::chart {
namespace {

constexpr double kSolidWall = 0.16, kSolidInnerRatio = 10;  // docs/calibration.md

}  // namespace

double unlocked_poisson_ratio(scene::Model model, double wanted) {
  constexpr double kUnlocked = 0.45;
  const bool locks = model == scene::Model::kCorotational || model == scene::Model::kXpbdTetrahedra;
  return locks ? std::min(wanted, kUnlocked) : wanted;
}

std::string Setting::name() const {
  return fmt::format("{}, level {}, {:g} Hz", scene::word_of(model), level, rate) +
         (iterations > 0 ? fmt::format(", {} iterations", iterations) : "");
}

std::string Setting::key() const {
  return fmt::format("{}-{}-{:g}", scene::word_of(model), level, rate) +
         (iterations > 0 ? fmt::format("-{}", iterations) : "");
}

std::vector<scene::Model> model_hierarchy() {
  using scene::Model;
  return {Model::kMassSpring,     Model::kImplicitVolume,   Model::kPenalty,
          Model::kPromayon,       Model::kElementVolume,    Model::kXpbdSprings,
          Model::kXpbdTetrahedra, Model::kCorotational,     Model::kNodalPressure,
          Model::kModal,          Model::kQuadraticElements};
}

scene::Organ solid_organ(const Setting& setting, double radius, std::size_t virtual_nodes,
                         double youngs_modulus, double density) {
  scene::Organ organ;
  organ.name = "solid";
  organ.model = setting.model;
  organ.iterations = setting.iterations;
  organ.tissue.youngs_modulus = youngs_modulus;
  organ.tissue.density = density;
  organ.tissue.wall_thickness = kSolidWall * radius;
  organ.springs.inner_ratio = kSolidInnerRatio;
  organ.springs.virtual_nodes = virtual_nodes;
  organ.solid.poisson_ratio = unlocked_poisson_ratio(setting.model, organ.solid.poisson_ratio);
  return organ;
}

geometry::OrganShape shape_for(const Setting& setting, const geometry::OrganShape& linear) {
  if (!scene::is_solid(setting.model)) return geometry::OrganShape(linear.surface);
  return scene::is_quadratic(setting.model) ? geometry::with_edge_nodes(linear) : linear;
}

}  // namespace palpate::chart
