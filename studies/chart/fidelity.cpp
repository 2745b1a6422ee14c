#include "studies/chart/fidelity.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "deformation/models.h"
#include "modules/scene/models.h"

namespace palpate::chart {
namespace {

constexpr double kSolidWall = 0.16, kSolidInnerRatio = 10;  // docs/calibration.md

}  // namespace

double unlocked_poisson_ratio(const std::string& model, double wanted) {
  constexpr double kUnlocked = 0.45;
  return scene::format_of(model).locks() ? std::min(wanted, kUnlocked) : wanted;
}

std::string Setting::name() const {
  return fmt::format("{}, level {}, {:g} Hz", model, level, rate) +
         (iterations > 0 ? fmt::format(", {} iterations", iterations) : "");
}

std::string Setting::key() const {
  return fmt::format("{}-{}-{:g}", model, level, rate) +
         (iterations > 0 ? fmt::format("-{}", iterations) : "");
}

std::vector<std::string> model_hierarchy() {
  std::vector<std::string> charted;
  for (const deformation::ModelRow& row : deformation::model_rows()) {
    if (row.is_charted) charted.emplace_back(row.word);
  }
  return charted;
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
