#include "deformation/model/following_mesh.h"

#include <catch2/catch.hpp>
#include <random>

#include "tests/deformation/steppers/tetrahedral_solids.h"

namespace palpate::deformation {
namespace {

constexpr double kPlateauUnderTip = 8e-3, kEdgeUnderTip = 5e-3;  // [m]

geometry::OrganShape coarse_cube() {
  return geometry::shape_of(geometry::testing::block(Vec3::Constant(0.06), 4, 4, 4));
}

TouchedPlace tip_at(const Vec3& centre) { return {centre, kPlateauUnderTip, kEdgeUnderTip}; }

bool same_shape(const RefinedShape& a, const RefinedShape& b) {
  return a.shape.surface.nodes == b.shape.surface.nodes &&
         a.shape.inner_nodes == b.shape.inner_nodes &&
         a.shape.surface.triangles == b.shape.surface.triangles &&
         a.shape.tetrahedra == b.shape.tetrahedra && a.shape.edge_nodes == b.shape.edge_nodes &&
         a.parents == b.parents && a.halvings == b.halvings;
}

TEST_CASE("following mesh: the same places give the same mesh, bit for bit, by any way there") {
  // Oracle: a mesh made anew. One tip and several, edges that fit the budget and that do not.
  const bool quadratic = GENERATE(false, true);
  const geometry::OrganShape coarse =
      quadratic ? geometry::with_edge_nodes(coarse_cube()) : coarse_cube();
  const std::size_t little = quadratic ? 3500 : 600;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 0.06);
  for (const std::size_t most : {std::size_t{20000}, little}) {
    int coarser = 0;
    FollowingMesh used(coarse, 0.6, most);
    for (int change = 0; change < 40; ++change) {
      std::vector<TouchedPlace> places;
      for (int i = 0; i <= change % 3; ++i) {
        places.push_back(tip_at({place(random), place(random), 0.06}));
      }
      const RefinedShape found = used.fine_at(places);
      CHECK(same_shape(found, FollowingMesh(coarse, 0.6, most).fine_at(places)));
      CHECK(found.shape.node_count() <= most);
      coarser += found.is_coarser ? 1 : 0;
    }
    CHECK((coarser > 20) == (most == little));
    CHECK((coarser == 0) == (most == 20000));
  }
}

TEST_CASE(
    "following mesh: nothing touched, it is the coarse mesh, and so it is with a full budget") {
  // Oracle: the coarse shape itself.
  const bool quadratic = GENERATE(false, true);
  const geometry::OrganShape coarse =
      quadratic ? geometry::with_edge_nodes(coarse_cube()) : coarse_cube();
  FollowingMesh mesh(coarse, 0.5, 10000);
  mesh.fine_at(std::vector{tip_at({0.03, 0.03, 0.06})});
  const RefinedShape at_rest = mesh.fine_at({});
  CHECK(at_rest.shape.surface.nodes == coarse.surface.nodes);
  CHECK(at_rest.shape.surface.triangles == coarse.surface.triangles);
  CHECK(at_rest.shape.tetrahedra == coarse.tetrahedra);
  CHECK(at_rest.shape.edge_nodes == coarse.edge_nodes);
  CHECK_FALSE(at_rest.is_coarser);
  FollowingMesh full(coarse, 0.5, 100);
  const RefinedShape kept = full.fine_at(std::vector{tip_at({0.03, 0.03, 0.06})});
  CHECK(kept.shape.tetrahedra == coarse.tetrahedra);
  CHECK(kept.is_coarser);
}

TEST_CASE(
    "following mesh: edges are as long as the places allow, no node is its parents' elsewhere") {
  // Oracle: definition.
  const bool quadratic = GENERATE(false, true);
  FollowingMesh mesh(quadratic ? geometry::with_edge_nodes(coarse_cube()) : coarse_cube(), 0.6,
                     20000);
  const std::vector places{tip_at({0.02, 0.02, 0.06}), tip_at({0.05, 0.03, 0.06})};
  const RefinedShape found = mesh.fine_at(places);
  const auto allowed = [&](const Vec3& x) {
    double least = 1;
    for (const TouchedPlace& place : places) {
      const double beyond = std::max(0.0, (x - place.centre).norm() - place.plateau);
      least = std::min(least, place.edge + 0.6 * beyond);
    }
    return least;
  };
  for (const auto& t : found.shape.tetrahedra) {
    for (const auto& [i, j] : geometry::kTetrahedronEdges) {
      const Vec3 p = found.shape.node(t[static_cast<std::size_t>(i)]),
                 q = found.shape.node(t[static_cast<std::size_t>(j)]);
      CHECK((p - q).norm() <= allowed((p + q) / 2) * (1 + 1e-12));
    }
  }
  for (std::size_t i = 0; i < found.shape.node_count(); ++i) {
    const auto& [a, b] = found.parents[i];
    if (a == geometry::HalvedMesh::kNone) continue;
    CHECK(found.shape.node(i) == (found.shape.node(a) + found.shape.node(b)) / 2);
  }
}

}  // namespace
}  // namespace palpate::deformation
