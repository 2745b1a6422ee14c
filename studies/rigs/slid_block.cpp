#include "studies/rigs/slid_block.h"

#include <algorithm>
#include <cmath>

#include "modules/geometry/bisection.h"
#include "modules/geometry/organ_shape.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/models.h"
#include "studies/report/measures.h"

namespace palpate::rigs {
namespace {

constexpr double kHalfWidth = 0.06, kHeight = 0.05;  // [m]
constexpr double kPlateau = 1.25;                    // radii; a mesh that follows has the same
constexpr std::size_t kMostCorners = 50'000;

geometry::OrganShape shape_of(const BlockSlide& slide, const std::string& model) {
  auto mesh = coarse_block(slide.coarse_edge);
  if (slide.small) {
    const auto size = [&](const Vec3& x) {
      const Vec3 along = slide.along();
      const double way = std::clamp(x.dot(along), -BlockSlide::kHalfWay, BlockSlide::kHalfWay);
      const double away = (x - way * along).norm() - kPlateau * slide.radius;
      return slide.small->edge + slide.small->growth * std::max(0.0, away);
    };
    mesh = geometry::bisected(mesh, size, kMostCorners);
  }
  const auto shape = geometry::shape_of(mesh);
  if (!scene::is_solid(model)) return geometry::OrganShape(shape.surface);
  return scene::is_quadratic(model) ? geometry::with_edge_nodes(shape) : shape;
}

scene::Scene scene_of(const BlockSlide& slide, scene::Organ organ) {
  scene::Scene scene;
  organ.name = "block";
  organ.fixed = {slid_block_base()};
  scene.organs.push_back(std::move(organ));
  scene.rates.deformation = slide.rate;
  scene.probes.push_back({"tip", scene::SphereShape{slide.radius}, 0.0, scene::ScriptedDevice{}});
  return scene;
}

}  // namespace

Vec3 BlockSlide::along() const { return {std::cos(direction), std::sin(direction), 0}; }

geometry::TetMesh coarse_block(double edge) {
  return geometry::mesh_block({-kHalfWidth, -kHalfWidth, -kHeight}, {kHalfWidth, kHalfWidth, 0},
                              report::text_of("%g", edge));
}

scene::Region slid_block_base() {
  return scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -kHeight + 1e-4)};
}

SlidBlock::SlidBlock(const BlockSlide& slide, scene::Organ organ)
    : slide_(slide),
      shape_(shape_of(slide, organ.model)),
      pressed_(scene_of(slide, std::move(organ)), shape_, {{at(0, -10e-3), Quat::Identity()}}) {}

Vec3 SlidBlock::at(double way, double depth) const {
  return way * slide_.along() + (slide_.radius - depth) * Vec3::UnitZ();
}

void SlidBlock::go(const Vec3& to, double speed) {
  pressed_.move_and_settle({to}, speed, [] {});
}

double SlidBlock::step(const Vec3& to) {
  pressed_.advance({{to, Quat::Identity()}});
  return pressed_.force(0).z();
}

}  // namespace palpate::rigs
