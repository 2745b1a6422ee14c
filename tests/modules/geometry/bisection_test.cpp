#include "modules/geometry/bisection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <tuple>

#include "modules/core/error.h"
#include "modules/geometry/organ_shape.h"
#include "tests/modules/geometry/scratch.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::geometry {
namespace {

constexpr std::size_t kMostNodes = 100'000;

/// Edges of `finest` about a ball, growing outside.
SizeField about(const Vec3& centre, double radius, double finest, double growth) {
  return
      [=](const Vec3& x) { return finest + growth * std::max(0.0, (x - centre).norm() - radius); };
}

/// 1 for a regular one, 0 for a flat one.
double mean_ratio(const TetMesh& mesh, const Tetrahedron& t) {
  double squares = 0;
  for (const auto& [a, b] : kTetrahedronEdges) {
    squares +=
        (mesh.nodes[t[static_cast<std::size_t>(a)]] - mesh.nodes[t[static_cast<std::size_t>(b)]])
            .squaredNorm();
  }
  const double volume =
      tetrahedron_volume(mesh.nodes[t[0]], mesh.nodes[t[1]], mesh.nodes[t[2]], mesh.nodes[t[3]]);
  return 12 * std::cbrt(9 * volume * volume) / squares;
}

double worst_ratio(const TetMesh& mesh) {
  double worst = 1;
  for (const Tetrahedron& t : mesh.tetrahedra) worst = std::min(worst, mean_ratio(mesh, t));
  return worst;
}

using Place = std::tuple<double, double, double>;

/// The tetrahedra by the places of their corners, whatever their numbers.
std::multiset<std::array<Place, 4>> places_of(const TetMesh& mesh) {
  std::multiset<std::array<Place, 4>> all;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    std::array<Place, 4> places;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3& x = mesh.nodes[t[k]];
      places[k] = {x.x(), x.y(), x.z()};
    }
    std::ranges::sort(places);
    all.insert(places);
  }
  return all;
}

/// No face belongs to more than two tetrahedra, and no edge has a node in its middle.
void check_conforming(const TetMesh& mesh) {
  std::map<std::array<std::uint32_t, 3>, int> faces;
  std::set<Place> places;
  for (const Vec3& x : mesh.nodes) CHECK(places.insert({x.x(), x.y(), x.z()}).second);
  int hanging = 0, most = 0;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const auto& face : kTetrahedronFaces) {
      std::array<std::uint32_t, 3> nodes{};
      for (std::size_t k = 0; k < 3; ++k) nodes[k] = t[static_cast<std::size_t>(face[k])];
      std::ranges::sort(nodes);
      most = std::max(most, ++faces[nodes]);
    }
    for (const auto& [a, b] : kTetrahedronEdges) {
      const Vec3 middle = (mesh.nodes[t[static_cast<std::size_t>(a)]] +
                           mesh.nodes[t[static_cast<std::size_t>(b)]]) /
                          2;
      hanging += places.contains({middle.x(), middle.y(), middle.z()}) ? 1 : 0;
    }
  }
  CHECK(most <= 2);
  CHECK(hanging == 0);
}

TetMesh shaken_block(unsigned seed) {
  TetMesh mesh = testing::block({0.08, 0.08, 0.08}, 4, 4, 4);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-2e-3, 2e-3);
  for (Vec3& x : mesh.nodes) x += Vec3(uniform(random), uniform(random), uniform(random));
  return mesh;
}

TEST_CASE("bisection: the mesh stays conforming and keeps its volume and its surface's") {
  // Oracle: brute force over faces and places; V of the coarse mesh; shape_of() takes closed
  // manifold boundaries only. A block on a lattice has ties among all its edges.
  TetMesh mixed = shaken_block(1);  // ties only where two of its tetrahedra meet a lattice's
  const TetMesh lattice = testing::block({0.08, 0.08, 0.08}, 4, 4, 4);
  for (std::size_t i = 0; i < mixed.nodes.size(); i += 2) mixed.nodes[i] = lattice.nodes[i];
  for (const TetMesh& coarse : {lattice, shaken_block(1), mixed}) {
    const TetMesh fine = bisected(coarse, about({0.03, 0.04, 0.08}, 8e-3, 4e-3, 0.5), kMostNodes);
    INFO(fine.nodes.size() << " nodes");
    CHECK(fine.nodes.size() > 4 * coarse.nodes.size());
    check_conforming(fine);
    const double volume = testing::volume_of(coarse);
    CHECK(testing::volume_of(fine) == Approx(volume).epsilon(1e-12));
    const OrganShape shape = shape_of(fine);
    CHECK(enclosed_volume(shape.surface.nodes, shape.surface.triangles) ==
          Approx(volume).epsilon(1e-12));
    CHECK(std::equal(coarse.nodes.begin(), coarse.nodes.end(), fine.nodes.begin()));
  }
}

TEST_CASE("bisection: no edge is longer than allowed, and far away nothing changes") {
  // Oracle: definition.
  const TetMesh coarse = shaken_block(2);
  const SizeField size = about({0.04, 0.04, 0.08}, 5e-3, 3e-3, 1.0);
  const TetMesh fine = bisected(coarse, size, kMostNodes);
  for (const Tetrahedron& t : fine.tetrahedra) {
    for (const auto& [a, b] : kTetrahedronEdges) {
      const Vec3 &p = fine.nodes[t[static_cast<std::size_t>(a)]],
                 &q = fine.nodes[t[static_cast<std::size_t>(b)]];
      CHECK((p - q).norm() <= size((p + q) / 2) * (1 + 1e-12));
    }
  }
  const auto before = places_of(coarse), after = places_of(fine);
  std::size_t kept = 0;
  for (const auto& t : before) kept += after.contains(t) ? 1 : 0;
  CHECK(kept > before.size() / 4);
}

TEST_CASE("bisection: the same sizes give the same mesh, whatever was asked for before") {
  // Oracle: by way of another mesh that is nowhere finer, bit for bit; numbers apart.
  const SizeField fine = about({0.03, 0.04, 0.08}, 8e-3, 4e-3, 0.5);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const TetMesh coarse = shaken_block(seed);
    const TetMesh at_once = bisected(coarse, fine, kMostNodes);
    TetMesh by_steps = coarse;
    for (const double factor : {4.0, 2.3, 1.4, 1.0}) {
      by_steps = bisected(
          by_steps, [&](const Vec3& x) { return factor * fine(x); }, kMostNodes);
    }
    CHECK(places_of(at_once) == places_of(by_steps));
    const TetMesh again = bisected(coarse, fine, kMostNodes);
    CHECK(again.tetrahedra == at_once.tetrahedra);
    CHECK(again.nodes == at_once.nodes);
  }
}

TEST_CASE("bisection: tetrahedra do not go flat, however often they are halved") {
  // Oracle: longest-edge bisection makes few shapes of a tetrahedron, again and again: the worst of
  // any depth stays above half of the coarse mesh's worst.
  const TetMesh coarse = shaken_block(3);
  for (const double finest : {8e-3, 4e-3, 2e-3, 1e-3, 0.5e-3}) {
    const double worst =
        worst_ratio(bisected(coarse, about({0.04, 0.04, 0.08}, 1e-3, finest, 0.7), kMostNodes));
    INFO("edges of " << finest << " m: " << worst << ", coarse " << worst_ratio(coarse));
    CHECK(worst > worst_ratio(coarse) / 2);
  }
}

TEST_CASE("bisection: a tree that was asked for others gives the mesh that one made anew gives") {
  // Oracle: bit for bit a fresh tree that is told of no growth and so looks at every edge, and
  // brute force over faces and places; the boundary and each middle's ends found again from the
  // nodes. Centres at random, some of them outside.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.01, 0.09);
  const TetMesh coarse = shaken_block(4);
  BisectionTree tree(coarse);
  for (int change = 0; change < 60; ++change) {
    const Vec3 centre(place(random), place(random), place(random));
    const SizeField size = about(centre, 8e-3, 5e-3, 0.6);
    REQUIRE(tree.choose(size, 0.6, kMostNodes));
    const HalvedMesh used = tree.mesh();
    const TetMesh fresh = bisected(coarse, size, kMostNodes);
    CHECK(used.mesh.nodes == fresh.nodes);
    CHECK(used.mesh.tetrahedra == fresh.tetrahedra);
    const auto boundary = boundary_triangles(fresh);
    REQUIRE(used.boundary.size() == boundary.size());
    for (std::size_t i = 0; i < boundary.size(); ++i) {
      CHECK(used.boundary[i].nodes == boundary[i].nodes);
    }
    for (std::size_t i = 0; i < fresh.nodes.size(); ++i) {
      const auto& [a, b] = used.parents[i];
      CHECK((a == HalvedMesh::kNone) == (i < coarse.nodes.size()));
      if (a != HalvedMesh::kNone) CHECK(fresh.nodes[i] == (fresh.nodes[a] + fresh.nodes[b]) / 2);
    }
    if (change % 10 != 0) continue;
    check_conforming(used.mesh);
    CHECK(testing::volume_of(used.mesh) == Approx(testing::volume_of(coarse)).epsilon(1e-12));
  }
}

TEST_CASE("bisection: a tree that would take too many nodes says so and goes on") {
  // Oracle: the number of nodes of the mesh itself, and the mesh of a fresh tree.
  const TetMesh coarse = shaken_block(4);
  BisectionTree tree(coarse);
  const SizeField size = about({0.04, 0.04, 0.08}, 8e-3, 3e-3, 0.5);
  const TetMesh fine = bisected(coarse, size, kMostNodes);
  CHECK_FALSE(tree.choose(size, 0.5, fine.nodes.size() - 1));
  CHECK(tree.choose(size, 0.5, fine.nodes.size()));
  CHECK(tree.mesh().mesh.tetrahedra == fine.tetrahedra);
}

TEST_CASE("bisection: more nodes than allowed are refused") {
  // Oracle: the message.
  CHECK_THROWS_WITH(bisected(
                        shaken_block(1), [](const Vec3&) { return 1e-3; }, 5000),
                    Catch::Contains("more than 5000 nodes"));
}

}  // namespace
}  // namespace palpate::geometry
