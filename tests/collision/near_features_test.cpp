#include "collision/near_features.h"

#include <catch2/catch.hpp>
#include <set>

#include "modules/geometry/self_intersection.h"
#include "tests/collision/random_shapes.h"

namespace palpate::collision {
namespace {

using Surfaces = std::vector<geometry::TriangleSurface>;

NearFeatures features_of(const Surfaces& surfaces, const TouchingKinds& kinds) {
  std::vector<std::vector<geometry::Triangle>> triangles;
  for (const auto& surface : surfaces) triangles.push_back(surface.triangles);
  return {std::move(triangles), kinds};
}

void search(NearFeatures& features, const Surfaces& surfaces, double reach) {
  std::vector<std::span<const Vec3>> positions;
  for (const auto& surface : surfaces) positions.emplace_back(surface.nodes);
  features.search(positions, reach);
}

FourPoints points_of(const FeaturePair& pair, const Surfaces& surfaces) {
  FourPoints x;
  for (std::size_t k = 0; k < 4; ++k) x[k] = surfaces[pair.surface_of(k)].nodes[pair.nodes[k]];
  return x;
}

bool shares_a_node(const FeaturePair& pair) {
  if (pair.surfaces[0] != pair.surfaces[1]) return false;
  for (std::size_t a = 0; a < pair.first_count(); ++a) {
    for (std::size_t b = pair.first_count(); b < 4; ++b) {
      if (pair.nodes[a] == pair.nodes[b]) return true;
    }
  }
  return false;
}

/// All pairs of two surfaces, or of one.
std::set<FeaturePair> all_pairs(const Surfaces& surfaces, std::uint32_t a, std::uint32_t b,
                                double reach) {
  std::set<FeaturePair> found;
  const auto consider = [&](const FeaturePair& pair) {
    if (shares_a_node(pair)) return;
    if (separation_of(pair.is_edges, points_of(pair, surfaces)).distance <= reach)
      found.insert(pair);
  };
  for (const auto& [of, with] : {std::pair(a, b), std::pair(b, a)}) {
    for (std::uint32_t node = 0; node < surfaces[of].nodes.size(); ++node) {
      for (const auto& t : surfaces[with].triangles)
        consider({{of, with}, false, {node, t[0], t[1], t[2]}});
    }
  }
  const auto first = geometry::edges_of(surfaces[a].triangles);
  const auto second = geometry::edges_of(surfaces[b].triangles);
  for (std::size_t e = 0; e < first.size(); ++e) {
    for (std::size_t f = a == b ? e + 1 : 0; f < second.size(); ++f) {
      consider({{a, b}, true, {first[e][0], first[e][1], second[f][0], second[f][1]}});
    }
  }
  return found;
}

/// Both touching kinds, as a search finds them.
std::set<FeaturePair> found_by(const NearFeatures& features) {
  std::set<FeaturePair> found;
  for (const NearPair& near : features.pairs()) CHECK(found.insert(near.pair).second);
  return found;
}

TEST_CASE("near features: all pairs within reach and no other, while surfaces move") {
  // Oracle: brute force over all nodes, triangles and edges.
  RandomShapes random(3);
  Surfaces surfaces;
  for (int i = 0; i < 3; ++i) surfaces.push_back(random.deformed_ball(0.05, 1));
  for (auto& x : surfaces[1].nodes) x += Vec3(0.1, 0, 0);
  for (auto& x : surfaces[2].nodes) x += Vec3(0, 0.101, 0);
  std::size_t count = 0;
  for (const TouchingKinds kinds : {TouchingKinds{true, false}, {false, true}, {true, true}}) {
    NearFeatures features = features_of(surfaces, kinds);
    for (int step = 0; step < 5; ++step) {
      for (auto& surface : surfaces) {
        for (Vec3& x : surface.nodes) x += random.point(4e-3);
      }
      const double reach = random.number(5e-3, 0.02);
      search(features, surfaces, reach);
      std::set<FeaturePair> expected;
      for (std::uint32_t a = 0; a < 3; ++a) {
        for (std::uint32_t b = a; b < 3; ++b) {
          if (a == b ? kinds.itself : kinds.others)
            expected.merge(all_pairs(surfaces, a, b, reach));
        }
      }
      CHECK(found_by(features) == expected);
      count += expected.size();
    }
  }
  CHECK(count > 1000);
}

/// The least distance of a pair that moves linearly, looked at many times.
double least_distance(bool is_edges, const FourPoints& start, const FourPoints& end) {
  double least = 1e300;
  for (int k = 0; k <= 400; ++k) {
    FourPoints x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = start[i] + k / 400.0 * (end[i] - start[i]);
    least = std::min(least, separation_of(is_edges, x).distance);
  }
  return least;
}

TEST_CASE(
    "near features: a pair that stays apart never met, and few that did not are held for it") {
  // Oracle: 401 looks at each motion. What came nearer than `least` must be told; what stayed
  // further than 2 √3 of it, the reach of the box about it, must not.
  constexpr double kLeast = 0.01;
  RandomShapes random(11);
  int met = 0, apart = 0;
  for (int k = 0; k < 4000; ++k) {
    const bool is_edges = k % 2 == 0;
    FourPoints start, end;
    for (int i = 0; i < 4; ++i) {
      start[i] = random.point(1);
      end[i] = start[i] + random.point(k % 3 == 0 ? 0.1 : 1);
    }
    const Separation before = separation_of(is_edges, start);
    if (before.distance < 4 * kLeast) continue;
    const double least = least_distance(is_edges, start, end);
    const bool stays = stays_apart(is_edges, start, end, before, kLeast);
    if (least < kLeast) CHECK_FALSE(stays);
    if (least > 2 * std::sqrt(3) * kLeast + 0.01) CHECK(stays);  // 0.01: between two looks
    met += least < kLeast;
    apart += stays;
  }
  CHECK(met > 100);
  CHECK(apart > 1000);
}

TEST_CASE("near features: a pair that does not move stays as near as it is") {
  // Oracle: definition.
  const FourPoints x{Vec3(0, 0, 1e-9), Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(0, 1, 0)};
  CHECK(stays_apart(false, x, x, separation_of(false, x), 1e-6));
}

TEST_CASE("near features: the separation from a triangle without area is that of its sides") {
  // Oracle: distance to a segment.
  const FourPoints x{Vec3(0.5, 2, 0), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(3, 0, 0)};
  const Separation found = separation_of(false, x);
  CHECK(found.distance == Approx(2));
  CHECK(found.direction == Vec3(0, -1, 0));
}

TEST_CASE("near features: surfaces that pass through each other or themselves are told") {
  // Oracle: two balls, apart, one inside the other, overlapping; a node pulled through the far
  // wall.
  Surfaces balls{geometry::make_ball(0.05, 2), geometry::make_ball(0.05, 2)};
  for (const auto& [offset, crosses] : {std::pair(0.11, false), std::pair(0.08, true)}) {
    for (std::size_t i = 0; i < balls[1].nodes.size(); ++i) {
      balls[1].nodes[i] = balls[0].nodes[i] + Vec3(offset, 0, 0);
    }
    NearFeatures features = features_of(balls, {true, true});
    search(features, balls, 0);
    CHECK(features.first_crossing().has_value() == crosses);
  }
  for (Vec3& x : balls[1].nodes) x = 0.3 * (x - Vec3(0.08, 0, 0));
  NearFeatures features = features_of(balls, {true, true});
  search(features, balls, 0);
  CHECK_FALSE(features.first_crossing());
  balls[0].nodes[0] *= -1.5;
  search(features, balls, 0);
  REQUIRE(features.first_crossing());
  CHECK_FALSE(geometry::find_self_intersections(balls[0]).empty());
}

}  // namespace
}  // namespace palpate::collision
