// What a step leaves behind, of every model.
#include <catch2/catch.hpp>

#include "tests/palpate/session/continued.h"
#include "tests/robustness/models_under_test.h"

namespace palpate {
namespace {

using deformation::testing::lopsided_shape;
using deformation::testing::models_under_test;

TEST_CASE(
    "snapshot: every model and integrator goes on with the bytes of a run never interrupted") {
  // Oracle: the same session without interruption; a round and a sharp probe press the organ.
  std::size_t touched = 0;
  for (const auto& under_test : models_under_test()) {
    INFO(under_test.model << ", integrator " << static_cast<int>(under_test.integrator));
    scene::Scene scene;
    scene.gravity.setZero();  // springs without contents would sink away from the probes
    scene::Organ organ;
    organ.name = "organ";
    organ.model = under_test.model;
    organ.integrator = under_test.integrator;
    organ.tissue.drag = 5;
    const auto shape = lopsided_shape(under_test.model);
    double top = -1, bottom = 1;
    for (std::size_t i = 0; i < shape.node_count(); ++i) {
      top = std::max(top, shape.node(i).z());
      bottom = std::min(bottom, shape.node(i).z());
    }
    const double height = top - bottom;
    organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, bottom + 0.3 * height)});
    scene.organs.push_back(organ);
    Vec3 centre = Vec3::Zero();
    for (std::size_t i = 0; i < shape.node_count(); ++i) {
      centre += shape.node(i) / static_cast<double>(shape.node_count());
    }
    const auto pressing = [&](double x) {
      scene::ScriptedDevice device;
      device.start = Vec3(centre.x() + x, centre.y(), top + 0.012);
      device.moves = {{device.start - Vec3(0, 0.003, 0.03), 0.15}, {std::nullopt, 1.0}};
      return device;
    };
    scene.probes.push_back({"round", scene::SphereShape{0.008}, 0.3, pressing(-0.012)});
    scene.probes.push_back(
        {"sharp", scene::BoxShape{Vec3(0.01, 0.01, 0.01)}, 0.3, pressing(0.012)});
    const session::Assets assets{{shape}, {{}, {}}};
    const auto both = session::testing::continued(scene, assets, 0.14, 0.2);
    touched += both.force > 0 ? 1 : 0;
    CHECK(session::testing::first_difference(both) == "");
  }
  CHECK(touched + 2 == models_under_test().size());  // springs without contents hold nothing up
}

}  // namespace
}  // namespace palpate
