#include "modules/geometry/continuous_collision.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "tests/collision/random_shapes.h"

namespace palpate::geometry {
namespace {

using collision::RandomShapes;

std::filesystem::path data_folder() {
  const char* named = std::getenv("PALPATE_DATA");
  return named != nullptr ? std::filesystem::path(named)
                          : std::filesystem::path(PALPATE_SOURCE_DIR) / "../shared/data";
}

struct Query {
  FourPoints start, end;
  bool meets = false;
};

std::vector<Query> read_queries(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<Query> queries;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    Query query;
    for (FourPoints* points : {&query.start, &query.end}) {
      for (Vec3& x : *points) row >> x[0] >> x[1] >> x[2];
    }
    row >> query.meets;
    REQUIRE(row);
    queries.push_back(query);
  }
  return queries;
}

FourPoints moved(const FourPoints& points, const Vec3& by) {
  FourPoints result = points;
  for (Vec3& x : result) x += by;
  return result;
}

}  // namespace

TEST_CASE("continuous collision: no meeting of the published queries is missed") {
  // Oracle: measured data, exact rational ground truth of Wang et al. 2021.
  const auto folder = data_folder() / "ccd";
  if (!std::filesystem::is_directory(folder)) {
    std::cout << "SKIPPED: no " << folder.string() << " (set PALPATE_DATA)\n";
    return;
  }
  int total = 0, meetings = 0, misses = 0, false_alarms = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().stem().string();
    const bool is_point = name.ends_with("__vf");
    if (!is_point && !name.ends_with("__ee")) continue;
    for (const Query& q : read_queries(entry.path())) {
      const auto impact =
          is_point ? point_triangle_impact(q.start, q.end) : edge_edge_impact(q.start, q.end);
      ++total;
      meetings += q.meets;
      misses += q.meets && !impact;
      false_alarms += !q.meets && impact;
    }
  }
  std::cout << "continuous collision: " << total << " published queries, " << meetings
            << " meetings, " << misses << " missed, " << false_alarms << " false alarms\n";
  CHECK(misses == 0);
  CHECK(total > 2000);
  CHECK(false_alarms <= 0.02 * (total - meetings));  // what is left passes within the tolerance
}

TEST_CASE("continuous collision: what passes by less than a rounding is told from what meets") {
  // Oracle: constructed in whole multiples of 2⁻⁵⁴, by hand. An upright edge falls past the end of
  // another that is a rounding above its own; the same where it just reaches.
  for (const bool reaches : {false, true}) {
    const double top = reaches ? 1 : 1 - 0x1p-53;
    const FourPoints start{Vec3(1, 0.75, 0), Vec3(1, 0.75, 1), Vec3(1, 0.5, 1), Vec3(-1, -1, 2)};
    FourPoints end = start;
    end[0] = Vec3(1, 0.25, 0);
    end[1] = Vec3(1, 0.25, top);
    CHECK(edge_edge_impact(start, end).has_value() == reaches);
    CHECK(edge_edge_impact(start, end, 1e-12));
  }
  // A point that slides over a triangle's plane, a quarter of a rounding above it.
  for (const double height : {0.0, 0x1p-55}) {
    const FourPoints start{Vec3(-2, 0.25, height), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    FourPoints end = start;
    end[0][0] = 2;
    CHECK(point_triangle_impact(start, end).has_value() == (height == 0));
  }
}

TEST_CASE("continuous collision: time and place of a point falling on a triangle") {
  // Oracle: analytic.
  const FourPoints start{Vec3(0.25, 0.25, 3), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  FourPoints end = start;
  end[0][2] = -1;
  const auto impact = point_triangle_impact(start, end);
  REQUIRE(impact);
  // The reported box is smaller than kImpactTolerance of the extent, 3.
  CHECK(impact->time == Approx(0.75).margin(1e-7));
  CHECK(impact->u == Approx(0.25).margin(1e-7));
  CHECK(impact->v == Approx(0.25).margin(1e-7));
  end[0][2] = 0.001;
  CHECK_FALSE(point_triangle_impact(start, end));
  CHECK(point_triangle_impact(start, end, 0.002));
}

TEST_CASE("continuous collision: the triangle may move instead of the point") {
  // Oracle: invariance under a common motion and under exchange of who moves.
  RandomShapes random(5);
  int hits = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    FourPoints start{random.point(1), random.point(1), random.point(1), random.point(1)};
    const Vec3 way = random.point(3);
    FourPoints point_moves = start, triangle_moves = moved(start, -way);
    point_moves[0] += way;
    triangle_moves[0] = start[0];
    const auto one = point_triangle_impact(start, point_moves);
    const auto other = point_triangle_impact(start, triangle_moves);
    CHECK(one.has_value() == other.has_value());
    if (one && other) CHECK(one->time == Approx(other->time).margin(1e-6));
    hits += one.has_value();
  }
  CHECK(hits > 20);
}

TEST_CASE("continuous collision: agrees with exact segment and triangle for a moving point") {
  // Oracle: brute force; the way of a point is a segment, whose distance to a resting triangle is
  // known in closed form. Ways that pass within 1e-6 may be called either way.
  RandomShapes random(6);
  for (int trial = 0; trial < 1000; ++trial) {
    const geometry::TriangleCorners t = random.triangle(1);
    const Vec3 from = random.point(1.5), to = random.point(1.5);
    const double apart = geometry::closest_of_segment_and_triangle(from, to, t).distance;
    const auto impact = point_triangle_impact({from, t[0], t[1], t[2]}, {to, t[0], t[1], t[2]});
    if (apart == 0) CHECK(impact);
    if (apart > 1e-6) CHECK_FALSE(impact);
  }
}

TEST_CASE("continuous collision: of a slender triangle, time and place are right too") {
  // Oracle: analytic; where a straight way crosses the plane. The triangles are as on a needle.
  RandomShapes random(8);
  int hits = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Quat turn = random.rotation();
    const geometry::TriangleCorners t{Vec3::Zero(), turn * Vec3(0.02, 0, 1),
                                      turn * Vec3(0.02 * std::cos(0.2), 0.02 * std::sin(0.2), 1)};
    const Vec3 on = t[0] + random.number(0.1, 0.9) * ((t[1] + t[2]) / 2 - t[0]);
    const Vec3 from = on + random.point(0.5), to = on + random.number(0.1, 1) * (on - from);
    const Vec3 normal = unit_normal(t);
    const double before = normal.dot(from - t[0]), after = normal.dot(to - t[0]);
    if (std::abs(before - after) < 1e-3) continue;
    const auto impact = point_triangle_impact({from, t[0], t[1], t[2]}, {to, t[0], t[1], t[2]});
    REQUIRE(impact);
    // Within kImpactTolerance of the extent, 1.5, over a height of 1e-3 at least.
    CHECK(impact->time == Approx(before / (before - after)).margin(1.5e-5));
    ++hits;
  }
  CHECK(hits > 2000);
}

TEST_CASE("continuous collision: edges meet where they cross") {
  // Oracle: constructed; two edges are made to cross at a chosen time and place.
  RandomShapes random(7);
  for (int trial = 0; trial < 300; ++trial) {
    const double time = random.number(0.05, 0.95), u = random.number(0.1, 0.9),
                 v = random.number(0.1, 0.9);
    const Vec3 place = random.point(1), d = random.direction(), e = random.direction();
    FourPoints at{place - u * d, place + (1 - u) * d, place - v * e, place + (1 - v) * e};
    const Vec3 velocity = random.point(2);
    FourPoints start = at, end = at;
    for (int k = 0; k < 2; ++k) {
      start[k] -= time * velocity;
      end[k] += (1 - time) * velocity;
    }
    const auto impact = edge_edge_impact(start, end);
    REQUIRE(impact);
    // Earlier only where the edges are nearly coplanar with their motion.
    CHECK(impact->time <= time + 1e-6);
  }
}

TEST_CASE("continuous collision: parallel edges that slide along each other are decided") {
  // Oracle: analytic; the degenerate case whose cubic vanishes.
  const FourPoints start{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(3, 0, 0)};
  FourPoints end = start;
  end[2][0] = 0.5;
  end[3][0] = 1.5;
  const auto impact = edge_edge_impact(start, end);
  REQUIRE(impact);
  CHECK(impact->time == Approx(2.0 / 3).margin(1e-6));
  CHECK_FALSE(edge_edge_impact(moved(start, Vec3::Zero()), start));
}

TEST_CASE("continuous collision: features that do not move meet exactly if they touch") {
  // Oracle: analytic.
  const FourPoints touching{Vec3(0.2, 0.2, 0), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const auto impact = point_triangle_impact(touching, touching);
  REQUIRE(impact);
  CHECK(impact->time == 0);
  FourPoints apart = touching;
  apart[0][2] = 1e-3;
  CHECK_FALSE(point_triangle_impact(apart, apart));
}

TEST_CASE("continuous collision: sides apart along a direction at both ends never meet") {
  // Oracle: the distance of the sides' hulls along it, sampled over the step; and the search
  // itself.
  RandomShapes random(37);
  std::size_t apart = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    FourPoints start, end;
    for (int k = 0; k < 4; ++k) {
      start[k] = random.triangle(1)[0];
      end[k] = start[k] + 0.5 * random.direction();
    }
    const Vec3 direction = random.direction();
    const std::size_t first_count = trial % 2 == 0 ? 1 : 2;
    const double least =
        std::min(gap_along(direction, first_count, start), gap_along(direction, first_count, end));
    for (double time = 0; time <= 1; time += 0.125) {
      double gap = 1e300;
      for (std::size_t i = 0; i < first_count; ++i) {
        for (std::size_t k = first_count; k < 4; ++k) {
          const Vec3 from = start[i] + time * (end[i] - start[i]);
          gap = std::min(gap, direction.dot(start[k] + time * (end[k] - start[k]) - from));
        }
      }
      CHECK(gap >= least - 1e-12);
    }
    if (least <= kImpactTolerance) continue;
    ++apart;
    const auto impact =
        first_count == 1 ? point_triangle_impact(start, end) : edge_edge_impact(start, end);
    CHECK_FALSE(impact);
  }
  CHECK(apart > 100);
}

}  // namespace palpate::geometry
