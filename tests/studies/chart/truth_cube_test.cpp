#include "studies/chart/truth_cube.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "modules/core/error.h"
#include "tests/studies/chart/folders.h"

namespace palpate::chart {
namespace {

TEST_CASE("truth cube: beads stand in a grid of 10 mm in the cube and sink under the plate") {
  // Oracle: the experiment's description, 7 × 7 × 7 beads 10 mm apart in a cube of 80 mm; tracking
  // was said to be good to some tenths of a millimetre.
  setenv("PALPATE_DATA", PALPATE_SOURCE_DIR "/../shared/data", 0);
  const auto folder = truth_cube_folder();
  if (!folder) {
    std::printf("SKIPPED: no truthcube in PALPATE_DATA\n");
    return;
  }
  const TruthCube cube = read_truth_cube(*truth_cube_folder());
  REQUIRE(cube.rest.size() == 343);
  REQUIRE(cube.states.size() == 3);
  Vec3 low = cube.rest[0], high = cube.rest[0];
  for (const Vec3& bead : cube.rest) low = low.cwiseMin(bead), high = high.cwiseMax(bead);
  for (int axis = 0; axis < 3; ++axis) CHECK(high[axis] - low[axis] == Approx(0.06).margin(0.005));
  for (const auto& [compression, beads] : cube.states) {
    double top = 0;
    int count = 0;
    for (std::size_t i = 0; i < beads.size(); ++i) {
      if (cube.rest[i].z() < 0.065) continue;
      top += cube.rest[i].z() - beads[i].z();
      ++count;
    }
    CHECK(top / count == Approx(0.08 * compression).epsilon(0.15));
    CHECK(tracking_noise(cube, compression) > 1e-4);
    CHECK(tracking_noise(cube, compression) < 5e-4);
  }
}

TEST_CASE("truth cube: rigid motion is taken out, other differences stay") {
  // Oracle: points moved by hand.
  std::vector<Vec3> points, turned, off;
  const Quat turn(Eigen::AngleAxisd(0.3, Vec3(1, 2, -1).normalized()));
  for (int i = 0; i < 20; ++i) {
    points.emplace_back(std::sin(i), std::cos(2.0 * i), std::sin(3.0 * i + 1));
    turned.push_back(turn * points.back() + Vec3(0.1, -0.2, 0.3));
    off.push_back(turned.back() + (i % 2 == 0 ? 1e-3 : -1e-3) * Vec3::UnitX());
  }
  CHECK(distance_after_fit(points, turned) < 1e-14);
  CHECK(distance_after_fit(points, off) == Approx(1e-3).epsilon(0.1));
}

TEST_CASE("truth cube: what cannot be read is refused with its place") {
  // Oracle: the stated messages.
  const testing::WorkFolder folder;
  CHECK_THROWS_WITH(read_truth_cube(folder.path), Catch::Contains("no such file"));
  std::ofstream(folder.path / "truthcube_uniaxial_positions.csv")
      << "1\n2\n3\n4\n5\n6\n7\n1,1,1,0,0,0,1,1,1,2,2\n";
  CHECK_THROWS_WITH(read_truth_cube(folder.path), Catch::Contains("positions.csv:8"));
}

}  // namespace
}  // namespace palpate::chart
