#include "studies/fuzz/minimise.h"

#include <catch2/catch.hpp>

namespace palpate::fuzz {
namespace {

TEST_CASE("minimise: nothing stays but what the failure needs") {
  // Oracle: a hand-made failure, of stiff tissue in any scene of two probes.
  const auto fails = [](const RandomScene& s) {
    return s.scene.probes.size() >= 2 && s.scene.organs[0].tissue.youngs_modulus > 1e5;
  };
  std::uint64_t k = 0;
  while (!fails(random_scene(5, k)) || random_scene(5, k).faults.empty()) ++k;
  const RandomScene small = minimised(random_scene(5, k), fails);
  REQUIRE(fails(small));
  CHECK(small.scene.probes.size() == 2);
  CHECK(small.scene.organs.size() == 1);
  CHECK(small.organ_shapes[0].shape == Shape::kTetrahedron);
  CHECK(small.faults.empty());
  CHECK(small.scene.organs[0].fixed.empty());
  CHECK(small.scene.organs[0].filling.points.empty());
  CHECK(small.scene.organs[0].tissue.density == scene::Tissue{}.density);
  CHECK(small.scene.duration <= 2e-3);
  CHECK(small.scene.gravity.isZero());
}

}  // namespace
}  // namespace palpate::fuzz
