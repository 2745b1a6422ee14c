#include "deformation/contact/organ_contact_rows.h"

#include <catch2/catch.hpp>

namespace palpate::deformation {
namespace {

StepPair pair_of(bool is_edges, std::array<std::uint32_t, 2> organs,
                 std::array<std::uint32_t, 4> nodes, const collision::FourPoints& points) {
  return {{organs, is_edges, nodes}, points, collision::separation_of(is_edges, points)};
}

TEST_CASE("organ contact rows: a place found from either side, or by several pairs, is one row") {
  // Oracle: by hand: node 7 of organ 0 above the side 4–5 of a triangle of organ 1, seen by both
  // triangles there and by an edge that ends in the node.
  const Vec3 node(0.5, 0, 1), a(0, 0, 0), b(1, 0, 0), c(0.5, 1, 0), d(0.5, -1, 0);
  std::vector<OrganContactRow> rows{
      row_between(pair_of(false, {0, 1}, {7, 4, 5, 6}, {node, a, b, c}), 0.1, 0.2, 0.5),
      row_between(pair_of(false, {0, 1}, {7, 5, 4, 8}, {node, b, a, d}), 0.1, 0.2, 0.5),
      row_between(pair_of(true, {0, 1}, {7, 9, 4, 5}, {node, node + Vec3(0, 0, 1), a, b}), 0.1, 0.2,
                  0.5),
      row_between(pair_of(true, {1, 0}, {4, 5, 9, 7}, {a, b, node + Vec3(0, 0, 1), node}), 0.1, 0.2,
                  0.5)};
  for (const OrganContactRow& row : rows) {
    CHECK(row.places[0].organ == 0);
    CHECK((row.normal - Vec3(0, 0, -1)).norm() < 1e-15);
    CHECK(row.approach == Approx(0.9 / 0.5));
    CHECK(row.friction == 0.2);
    CHECK(key_of(row) == key_of(rows[0]));
  }
  keep_each_once(rows);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].places[0].weights.sum() == 1);
  CHECK(rows[0].places[1].weights.sum() == Approx(1));
}

TEST_CASE("organ contact rows: rows of different places stay, in order") {
  // Oracle: sorted keys.
  const collision::FourPoints points{Vec3(0.2, 0.2, 1), Vec3(0, 0, 0), Vec3(1, 0, 0),
                                     Vec3(0, 1, 0)};
  std::vector<OrganContactRow> rows;
  for (const std::uint32_t node : {9u, 3u, 5u, 3u}) {
    rows.push_back(row_between(pair_of(false, {1, 0}, {node, 0, 1, 2}, points), 0, 0, 1));
  }
  keep_each_once(rows);
  REQUIRE(rows.size() == 3);
  for (std::size_t r = 1; r < rows.size(); ++r) CHECK(key_of(rows[r - 1]) < key_of(rows[r]));
}

TEST_CASE("organ contact rows: each side sees the other as a probe, with opposite impulses") {
  // Oracle: Newton's third law; the other place's velocity.
  const Body body;
  const std::vector<TouchedOrgan> organs{{&body, {Vec3(1, 2, 3)}}, {&body, {Vec3(4, 5, 6)}}};
  OrganContactRow row;
  row.places = {OrganPlace{0, {}, Vec3(1, 0, 0)}, OrganPlace{1, {}, Vec3(1, 0, 0)}};
  row.normal_impulse = 2;
  row.tangential_impulse = Vec3(0.5, 0, 0);
  const auto on_tissue = [](const ContactRow& seen) -> Vec3 {
    return seen.tangential_impulse - seen.normal_impulse * seen.normal;
  };
  const ContactRow first = seen_from(row, 0, organs), second = seen_from(row, 1, organs);
  CHECK(on_tissue(second) == row.impulse());
  CHECK(on_tissue(first) == -row.impulse());
  CHECK(first.probe_velocity == Vec3(4, 5, 6));
  CHECK(second.probe_velocity == Vec3(1, 2, 3));
}

}  // namespace
}  // namespace palpate::deformation
