#include "bench/fine_surface.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"

namespace palpate::bench {

TEST_CASE("fine surface: about as many nodes as asked for, closed, of the same volume") {
  // Oracle: Euler's formula; halving edges gives 4 n - 6 nodes and keeps every triangle's plane.
  const auto ball = geometry::make_ball(0.05, 3);
  const auto coarse = fine_surface(ball, 6'000), fine = fine_surface(ball, 24'000);
  CHECK(coarse.nodes.size() == 6'000);
  CHECK(fine.nodes.size() == 4 * 6'000 - 6);
  CHECK(fine.triangles.size() == 2 * fine.nodes.size() - 4);
  const double volume = geometry::enclosed_volume(coarse.nodes, coarse.triangles);
  CHECK(geometry::enclosed_volume(fine.nodes, fine.triangles) == Approx(volume));
}

}  // namespace palpate::bench
