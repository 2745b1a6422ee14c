#include "bench/solids/step_cost.h"

#include <catch2/catch.hpp>

#include "tests/modules/geometry/tetrahedra.h"

using namespace palpate;

TEST_CASE("step cost of solids: is printed for both models") {
  // Oracle: none but that it runs; numbers are for readers.
  const auto mesh = geometry::testing::block(Vec3::Constant(0.06), 2, 2, 2);
  for (const auto model : {"corotational", "nodal_pressure"}) {
    CHECK_NOTHROW(solids_bench::print_step_cost(model, mesh));
  }
}
