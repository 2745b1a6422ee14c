// Scenes whose organs are solids: what is loaded of them.
#include <catch2/catch.hpp>
#include <fstream>

#include "deformation/model/organ_model.h"
#include "modules/core/error.h"
#include "modules/scene/assets.h"
#include "tests/modules/geometry/tetrahedra.h"
#include "tests/studies/chart/folders.h"

namespace palpate {
namespace {

scene::Organ ball(const std::string& model) {
  scene::Organ organ;
  organ.name = "ball";
  organ.model = model;
  organ.mesh.file = std::filesystem::path(PALPATE_SOURCE_DIR) / "scenes/meshes/ball.ply";
  organ.mesh.nodes = 200;
  organ.pose.position = Vec3(0, 0, 1);
  return organ;
}

TEST_CASE("solid assets: a surface is filled where its model is a solid, and placed") {
  // Oracle: the surface of the same organ; the pose.
  if (geometry::testing::without_gmsh()) return;
  const auto surface = scene::load_organ(ball("implicit_volume"));
  const auto solid = scene::load_organ(ball("corotational"));
  const auto quadratic = scene::load_organ(ball("quadratic_elements"));
  CHECK_FALSE(surface.is_solid());
  REQUIRE(solid.is_solid());
  CHECK(solid.surface.nodes == surface.surface.nodes);
  CHECK(quadratic.surface.nodes.size() == 4 * surface.surface.nodes.size() - 6);
  for (const Vec3& node : solid.inner_nodes) CHECK((node - Vec3(0, 0, 1)).norm() < 0.05);
}

TEST_CASE("solid assets: masses of a solid add up to density times volume") {
  // Oracle: the volume of its tetrahedra, linear and quadratic.
  if (geometry::testing::without_gmsh()) return;
  for (const std::string model : {"corotational", "quadratic_elements"}) {
    const auto organ = ball(model);
    const auto shape = scene::load_organ(organ);
    const auto built = deformation::build_organ_model(organ, Vec3::Zero(), shape);
    double mass = 0;
    for (const double m : built.masses) {
      CHECK(m > 0);
      mass += m;
    }
    CHECK(mass == Approx(organ.tissue.density * built.rest_volume));
    for (const double k : built.node_stiffness) CHECK(k > 0);
  }
}

TEST_CASE("solid assets: what does not go with a solid is refused") {
  // Oracle: the messages.
  if (geometry::testing::without_gmsh()) return;
  auto organ = ball("corotational");
  organ.solid.poisson_ratio = 0.5;
  const auto shape = scene::load_organ(organ);
  CHECK_THROWS_WITH(
      deformation::build_organ_model(organ, Vec3::Zero(), shape),
      Catch::Contains("'solid.poisson_ratio': model corotational needs at most 0.4999"));
  organ.solid.poisson_ratio = 0.45;
  organ.filling.breathing_amplitude = 0.1;
  CHECK_THROWS_WITH(deformation::build_organ_model(organ, Vec3::Zero(), shape),
                    Catch::Contains("'filling': does not go with model corotational"));
  const chart::testing::WorkFolder folder;
  std::ofstream(folder.path / "a.msh") << "nothing";
  organ.mesh.file = folder.path / "a.msh";
  CHECK_THROWS_WITH(scene::load_organ(organ), Catch::Contains("'nodes' resamples surfaces only"));
  organ.mesh.nodes = 0;
  CHECK_THROWS_WITH(scene::load_organ(organ), Catch::Contains("organ 'ball'"));
}

}  // namespace
}  // namespace palpate
