#include "collision/contact_reduction.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/collision/finder_scene.h"
#include "tests/collision/step_scene.h"

namespace palpate::collision {
namespace {

FoundContact contact(std::uint32_t organ, std::uint32_t triangle, const Vec3& weights, double gap) {
  FoundContact result;
  result.organ = organ;
  result.triangle = triangle;
  result.barycentric = weights;
  result.gap = gap;
  result.point_P = Vec3(0, 0, gap);
  return result;
}

}  // namespace

TEST_CASE("contact reduction: a place named by two triangles is one contact, of the lowest") {
  // Oracle: analytic.
  std::vector<FoundContact> found;
  append_contact(contact(0, 7, {0.25, 0.75, 0}, 0.1), {4, 5, 6}, found);
  append_contact(contact(0, 3, {0.75, 0, 0.25}, 0.1), {5, 9, 4}, found);
  append_contact(contact(1, 2, {0.75, 0, 0.25}, 0.1), {5, 9, 4}, found);  // another organ
  CHECK(found[0].feature == std::array{4u, 5u, kNoNode});
  CHECK(found[0].feature == found[1].feature);
  ContactSet result;
  reduce_contacts(found, kMostContacts, result);
  REQUIRE(result.contacts.size() == 2);
  CHECK(result.contacts[0].triangle == 3);
  CHECK(result.contacts[1].organ == 1);
}

TEST_CASE("contact reduction: the same place with another normal or probe point is kept") {
  // Oracle: analytic.
  std::vector<FoundContact> found;
  append_contact(contact(0, 7, {1, 0, 0}, 0.1), {4, 5, 6}, found);
  FoundContact turned = contact(0, 7, {1, 0, 0}, 0.1), moved = turned;
  turned.normal_P = Vec3::UnitX();
  moved.point_P[0] = 0.01;
  append_contact(turned, {4, 5, 6}, found);
  append_contact(moved, {4, 5, 6}, found);
  ContactSet result;
  reduce_contacts(found, kMostContacts, result);
  CHECK(result.contacts.size() == 3);
}

TEST_CASE("contact reduction: the deepest are kept, sorted, in whatever order they were found") {
  // Oracle: brute force sort.
  RandomShapes random(81);
  std::vector<FoundContact> found;
  for (std::uint32_t t = 0; t < 2 * kMostContacts; ++t) {
    append_contact(contact(t % 2, t, {0.2, 0.3, 0.5}, random.number(-1, 1)),
                   {3 * t, 3 * t + 1, 3 * t + 2}, found);
  }
  std::vector<double> gaps;
  for (const FoundContact& c : found) gaps.push_back(c.gap);
  std::sort(gaps.begin(), gaps.end());
  auto reversed = found;
  std::reverse(reversed.begin(), reversed.end());
  ContactSet one, other;
  reduce_contacts(found, kMostContacts, one);
  reduce_contacts(reversed, kMostContacts, other);
  CHECK(one.truncated);
  REQUIRE(one.contacts.size() == kMostContacts);
  REQUIRE(other.contacts.size() == kMostContacts);
  for (std::size_t i = 0; i < kMostContacts; ++i) {
    CHECK(one.contacts[i].gap <= gaps[kMostContacts - 1]);
    CHECK(one.contacts[i].gap == other.contacts[i].gap);
    CHECK(one.contacts[i].triangle == other.contacts[i].triangle);
    if (i == 0) continue;
    const Contact& before = one.contacts[i - 1];
    CHECK(std::pair(before.organ, before.triangle) <
          std::pair(one.contacts[i].organ, one.contacts[i].triangle));
  }
}

TEST_CASE("contact reduction: hands out what was found, its normal made unit") {
  // Oracle: definition.
  RandomShapes random(82);
  std::vector<FoundContact> found;
  FoundContact c = contact(0, 1, {1, 0, 0}, -0.2);
  c.point_P = random.point(1);
  const Vec3 direction = random.direction();
  c.normal_P = (1 + 1e-9) * direction;
  append_contact(c, {0, 1, 2}, found);
  ContactSet result;
  reduce_contacts(found, kMostContacts, result);
  REQUIRE(result.contacts.size() == 1);
  CHECK_FALSE(result.truncated);
  CHECK(result.contacts[0].point_P == c.point_P);
  CHECK((result.contacts[0].normal_P - direction).norm() < 1e-15);
  CHECK(result.contacts[0].gap == -0.2);
}

TEST_CASE("contact reduction: a node is named by its lowest triangle") {
  // Oracle: brute force.
  const auto ball = geometry::make_ball(1, 1);
  const StepScene scene(ball, Vec3::Zero());
  for (std::uint32_t node = 0; node < ball.nodes.size(); ++node) {
    std::vector<FoundContact> found;
    append_node_contact(scene.step, node, {}, found);
    std::uint32_t lowest = 0;
    while (std::count(ball.triangles[lowest].begin(), ball.triangles[lowest].end(), node) == 0)
      ++lowest;
    CHECK(found[0].triangle == lowest);
    int corner = 0;
    CHECK(found[0].barycentric.maxCoeff(&corner) == 1);
    CHECK(ball.triangles[lowest][corner] == node);
    CHECK(found[0].barycentric.sum() == 1);
  }
}

}  // namespace palpate::collision
