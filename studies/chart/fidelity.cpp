#include "studies/chart/fidelity.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

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

const char* word_of(Small small) {
  return small == Small::kNowhere ? "" : small == Small::kAtPlaces ? "near" : "follow";
}

std::string Setting::name() const {
  const char* where = small == Small::kAtPlaces    ? " where it is touched"
                      : small == Small::kFollowing ? " following"
                                                   : "";
  return fmt::format("{}, level {}{}, {:g} Hz", model, level, where, rate) +
         (iterations > 0 ? fmt::format(", {} iterations", iterations) : "");
}

std::string Setting::key() const {
  return fmt::format("{}-{}-{:g}", model, level, rate) +
         (iterations > 0 ? fmt::format("-{}", iterations) : "") +
         (small != Small::kNowhere ? fmt::format("-{}", word_of(small)) : "") +
         (places > 0 ? fmt::format("-{}places", places) : "");
}

SmallTetrahedra small_tetrahedra(const Setting& setting) {
  static constexpr std::array<SmallTetrahedra, kSmallLevels> kLinear{
      {{0.5, 0.5, 1}, {1.0 / 3, 0.5, 1}}};
  static constexpr std::array<SmallTetrahedra, kSmallLevels> kQuadratic{
      {{1, 1, 0.5}, {0.7, 1, 0.5}}};
  const auto level = static_cast<std::size_t>(setting.level);
  return (scene::is_quadratic(setting.model) ? kQuadratic : kLinear).at(level);
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
