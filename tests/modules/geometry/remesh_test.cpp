#include "modules/geometry/remesh.h"

#include "modules/geometry/mesh_check.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;

TEST_CASE("remesh: a surface goes into half-edges and back unchanged") {
  // Oracle: round trip.
  const TriangleSurface ball = make_ball(0.05, 2);
  const TriangleSurface back = to_surface(to_remesh_mesh(ball));
  CHECK(back.nodes == ball.nodes);
  CHECK(check_surface(back).holds_volume());
  CHECK(back.triangles.size() == ball.triangles.size());
}

TEST_CASE("remesh: splitting keeps the shape and leaves no long edge") {
  // Oracle: invariants: volume and area of a box do not change by splitting its edges.
  RemeshMesh mesh = to_remesh_mesh(make_box({1, 1, 1}));
  while (split_long_edges(mesh, 0.4, 100'000) > 0) {
  }
  const MeshReport report = check_surface(to_surface(mesh));
  CHECK(report.longest_edge <= 0.4);
  CHECK(report.volume == Approx(1).epsilon(1e-13));
  CHECK(report.area == Approx(6).epsilon(1e-13));
  CHECK(report.holds_volume());
}

TEST_CASE("remesh: splitting stops at the node count") {
  // Oracle: the contract.
  RemeshMesh mesh = to_remesh_mesh(make_ball(1, 1));
  while (split_long_edges(mesh, 0, 57) > 0) {
  }
  CHECK(mesh.n_vertices() == 57);
}

TEST_CASE("remesh: collapsing stops at the count, stays on the target, closed and unfolded") {
  // Oracle: invariants; nodes are nearest points of the target surface.
  const TriangleSurface ball = make_ball(1, 3);
  const AabbTree target(ball);
  RemeshMesh mesh = to_remesh_mesh(ball);
  const double infinity = std::numeric_limits<double>::infinity();
  while (collapse_short_edges(mesh, target, infinity, infinity, 100) > 0) {
  }
  const TriangleSurface result = to_surface(mesh);
  const MeshReport report = check_surface(result);
  CHECK(report.node_count == 100);
  CHECK(report.holds_volume());
  for (const Vec3& node : result.nodes) CHECK(target.nearest(node).squared_distance < 1e-24);
}

TEST_CASE("remesh: a tetrahedron is never collapsed further") {
  // Oracle: topology: four nodes are the fewest of a closed surface.
  const TriangleSurface tetrahedron = make_tetrahedron(1);
  RemeshMesh mesh = to_remesh_mesh(tetrahedron);
  CHECK(collapse_short_edges(mesh, AabbTree(tetrahedron), 10, 10, 1) == 0);
}

TEST_CASE("remesh: flips bring valences nearer to six, relaxing evens out the triangles") {
  // Oracle: invariants on a ball whose longest edges were halved: squared valence errors fall, and
  // so does the worst aspect.
  const TriangleSurface ball = make_ball(1, 2);
  const AabbTree target(ball);
  RemeshMesh mesh = to_remesh_mesh(ball);
  while (split_long_edges(mesh, 0, 400) > 0) {
  }
  const auto valence_error = [&] {
    double sum = 0;
    for (const auto v : mesh.vertices()) sum += std::pow(double(mesh.valence(v)) - 6, 2);
    return sum;
  };
  const double before = valence_error();
  const double worst_before = check_surface(to_surface(mesh)).worst_aspect;
  CHECK(equalize_valences(mesh) > 0);
  CHECK(valence_error() < before);
  for (int i = 0; i < 10; ++i) {
    equalize_valences(mesh);
    relax_on(mesh, target);
  }
  const MeshReport report = check_surface(to_surface(mesh));
  CHECK(report.holds_volume());
  CHECK(report.worst_aspect < worst_before);
}

TEST_CASE("remesh: edges by length are sorted and complete") {
  // Oracle: brute force lengths of a box with edges 1, 2, 3.
  const RemeshMesh mesh = to_remesh_mesh(make_box({1, 2, 3}));
  const auto edges = edges_by_length(mesh);
  CHECK(edges.size() == 18);
  CHECK(std::is_sorted(edges.begin(), edges.end()));
  CHECK(edges.front().first == Approx(1));
  CHECK(edges.back().first == Approx(std::sqrt(13.0)));
}
