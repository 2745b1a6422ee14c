#include "palpate/mesh_near_motion.h"

#include <catch2/catch.hpp>

#include "tests/modules/geometry/tetrahedra.h"
#include "tests/scratch_folder.h"

namespace palpate::geometry {
namespace {

TEST_CASE("mesh near a motion: no part of a fast way is left out, and its stay counts once") {
  // Oracle: the way; 50 mm between two samples, 4 mm deep in a block's top, then a rest with 0.1 mm
  // of trembling. A place stands for 0.75 radii around it, and the way is looked at by quarters.
  const ScratchFolder folder;
  std::string table = "t,x,y,z,qx,qy,qz,qw\n0,0.005,0.03,0.064,0,0,0,1\n";
  for (int k = 1; k < 50; ++k) {
    table +=
        std::to_string(0.05 * k) + (k % 2 == 0 ? ",0.055," : ",0.0551,") + "0.03,0.064,0,0,0,1\n";
  }
  NearMotion motion;
  motion.file = folder.write("way.csv", table);
  motion.radius = 8e-3;
  const auto [mesh, refine] =
      refined_near(testing::block(Vec3::Constant(0.06), 4, 4, 4), motion, read_way(motion));
  CHECK(refine.edge_length == 4e-3);
  for (double x = 5e-3; x <= 55e-3; x += 1e-3) {
    double nearest = 1;
    for (const auto& region : refine.near) {
      const auto& ball = std::get<scene::SphereRegion>(region);
      CHECK(ball.radius == 8e-3);
      nearest = std::min(nearest, (ball.center - Vec3(x, 0.03, 0.06)).norm());
    }
    CHECK(nearest <= (0.75 + 0.25) * 8e-3);
  }
  CHECK(refine.near.size() <= 1 + 50 / 6);
  CHECK(mesh.nodes.size() > 125);
}

}  // namespace
}  // namespace palpate::geometry
