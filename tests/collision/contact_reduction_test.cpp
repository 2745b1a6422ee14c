#include "collision/contact_reduction.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <random>
#include <set>
#include <span>

#include "collision/thinning.h"
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
  reduce_contacts(found, false, kMost, result);
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
  reduce_contacts(found, false, kMost, result);
  CHECK(result.contacts.size() == 3);
}

TEST_CASE("contact reduction: the deepest are kept, sorted, in whatever order they were found") {
  // Oracle: brute force sort.
  RandomShapes random(81);
  std::vector<FoundContact> found;
  for (std::uint32_t t = 0; t < 2 * kMost.contacts; ++t) {
    append_contact(contact(t % 2, t, {0.2, 0.3, 0.5}, random.number(-1, 1)),
                   {3 * t, 3 * t + 1, 3 * t + 2}, found);
  }
  std::vector<double> gaps;
  for (const FoundContact& c : found) gaps.push_back(c.gap);
  std::sort(gaps.begin(), gaps.end());
  auto reversed = found;
  std::reverse(reversed.begin(), reversed.end());
  ContactSet one, other;
  reduce_contacts(found, false, kMost, one);
  reduce_contacts(reversed, false, kMost, other);
  CHECK(one.truncated);
  REQUIRE(one.contacts.size() == kMost.contacts);
  REQUIRE(other.contacts.size() == kMost.contacts);
  for (std::size_t i = 0; i < kMost.contacts; ++i) {
    CHECK(one.contacts[i].gap <= gaps[kMost.contacts - 1]);
    CHECK(one.contacts[i].gap == other.contacts[i].gap);
    CHECK(one.contacts[i].triangle == other.contacts[i].triangle);
    if (i == 0) continue;
    const Contact& before = one.contacts[i - 1];
    CHECK(std::pair(before.organ, before.triangle) <
          std::pair(one.contacts[i].organ, one.contacts[i].triangle));
  }
}

TEST_CASE("contact reduction: where a place has many, what touches and its nearest are never cut") {
  // Oracle: brute force over each place's gaps: 300 places, ten contacts with each of them.
  RandomShapes random(85);
  std::vector<FoundContact> found;
  std::vector<double> nearest(300, 2), others;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const std::uint32_t t = i % 300;
    FoundContact c = contact(t % 2, t, {0.2, 0.3, 0.5}, random.number(-0.05, 1));
    c.point_P = random.point(1);
    append_contact(c, {3 * t, 3 * t + 1, 3 * t + 2}, found);
    nearest[t] = std::min(nearest[t], c.gap);
  }
  std::vector<double> kept;
  std::size_t touching = 0;
  for (const FoundContact& c : found) {
    touching += c.gap <= 0;
    (c.gap <= 0 || c.gap == nearest[c.triangle] ? kept : others).push_back(c.gap);
  }
  const std::vector<FoundContact> all = found;
  std::sort(others.begin(), others.end());
  kept.insert(kept.end(), others.begin(),
              others.begin() + static_cast<std::ptrdiff_t>(kMost.contacts - kept.size()));
  std::sort(kept.begin(), kept.end());
  ContactSet result;
  reduce_contacts(found, false, kMost, result);
  CHECK(touching > 100);
  CHECK_FALSE(result.truncated);
  std::vector<double> gaps;
  for (const Contact& c : result.contacts) gaps.push_back(c.gap);
  std::sort(gaps.begin(), gaps.end());
  CHECK(gaps == kept);
  // Fewer than touch, or than there are places, are made up for while a message holds them; those
  // that nobody needs are not.
  found = all;
  reduce_contacts(found, false, {50, 0, 0, 2000}, result);
  CHECK_FALSE(result.truncated);
  CHECK(result.contacts.size() == all.size() - others.size());
  double deepest_unneeded = 0;
  for (const Contact& c : result.contacts) {
    if (c.gap > 0 && c.gap != nearest[c.triangle]) deepest_unneeded = c.gap;
  }
  CHECK(deepest_unneeded == 0);
  // Beyond what it holds that is said.
  for (const std::size_t most : {std::size_t{50}, std::size_t{299}}) {
    found = all;
    reduce_contacts(found, false, {most, 0, 0}, result);
    CHECK(result.truncated);
    CHECK(result.contacts.size() == most);
  }
}

TEST_CASE(
    "contact reduction: what a probe cannot come to is left out first, and what it meets last") {
  // Oracle: each place's gap after the way ahead and half the margin to any side, and on that way.
  RandomShapes random(86);
  const ProbeReach reach{Vec3(0.1, -0.2, 0.15), 0.7};
  std::vector<FoundContact> found;
  std::vector<double> reached, sooner;
  for (std::uint32_t t = 0; t < 1000; ++t) {
    FoundContact c = contact(0, t, {0.2, 0.3, 0.5}, random.number(-0.05, 0.7));
    c.point_P = random.point(1);
    c.normal_P = random.direction();
    append_contact(c, {3 * t, 3 * t + 1, 3 * t + 2}, found);
    const double after = c.gap + c.normal_P.dot(reach.ahead_P);
    if (c.gap > 0 && after > reach.margin - reach.ahead_P.norm()) continue;
    reached.push_back(c.gap);
    sooner.push_back(std::min(c.gap, after));
  }
  REQUIRE(reached.size() > 300);
  REQUIRE(reached.size() < 900);
  const std::vector<FoundContact> all = found;
  ContactSet result;
  reduce_contacts(found, false, {reached.size(), 0, 0}, result, reach);
  CHECK_FALSE(result.truncated);
  std::vector<double> gaps;
  for (const Contact& c : result.contacts) gaps.push_back(c.gap);
  std::ranges::sort(gaps);
  std::ranges::sort(reached);
  CHECK(gaps == reached);

  found = all;
  const std::size_t most = reached.size() / 2;
  reduce_contacts(found, false, {most, 0, 0}, result, reach);
  CHECK(result.truncated);
  REQUIRE(result.contacts.size() == most);
  std::ranges::sort(sooner);
  for (const Contact& c : result.contacts) CHECK(reach.least_gap(c) < sooner[most]);
}

TEST_CASE("contact reduction: nodes on one plane are a face, all of them, and truncate nothing") {
  // Oracle: the planes they were laid on.
  RandomShapes random(83);
  std::vector<FoundContact> found;
  std::map<std::pair<std::uint32_t, double>, std::set<std::uint32_t>> laid;
  std::map<std::pair<std::uint32_t, double>, double> deepest;
  for (std::uint32_t node = 0; node < 6000; ++node) {
    FoundContact c;
    c.organ = node % 2;
    c.triangle = node;
    c.gap = random.number(-1, 1);
    const double height = node % 3 == 0 ? 0.25 : node % 3 == 1 ? -0.5 : 1e-4 * node;
    c.point_P = Vec3(random.number(-1, 1), random.number(-1, 1), height);
    c.barycentric = Vec3::UnitX();
    append_contact(c, {node, node + 1, node + 2}, found);
    if (node % 3 == 2) continue;
    laid[{c.organ, height}].insert(node);
    deepest[{c.organ, height}] = std::min(c.gap, deepest[{c.organ, height}]);
  }
  std::shuffle(found.begin(), found.end(), std::mt19937(1));
  ContactSet result;
  reduce_contacts(found, false, {3000, 4, 4000}, result);
  CHECK_FALSE(result.truncated);
  CHECK(result.contacts.size() == 2000);  // each on a plane of its own
  CHECK(result.count() == 6000);
  REQUIRE(result.faces.size() == 4);
  std::size_t first = 0;
  for (const FaceContacts& face : result.faces) {
    const auto nodes = std::span(result.face_nodes).subspan(first, face.node_count);
    first += face.node_count;
    const std::pair key(face.organ, face.point_P.z());
    CHECK(std::set(nodes.begin(), nodes.end()) == laid.at(key));
    CHECK(std::is_sorted(nodes.begin(), nodes.end()));  // by their triangles, which go with nodes
    CHECK(face.gap == deepest.at(key));
    CHECK(face.normal_P == Vec3::UnitZ());
  }
  CHECK(result.faces[0].organ + result.faces[1].organ == 0);
  reduce_contacts(found, false, {1999, 4, 4000},
                  result);  // what is left of `found` is what is on no face
  CHECK(result.truncated);
}

TEST_CASE("contact reduction: faces that do not fit are contacts, and what is left out is said") {
  // Oracle: counts; 400 nodes are laid on ten planes, 40 on each.
  const auto reduced = [](const ContactLimits& limits) {
    std::vector<FoundContact> found;
    for (std::uint32_t node = 0; node < 400; ++node) {
      FoundContact c;
      c.triangle = node;
      c.organ = node % 2;
      c.gap = 1e-3 * node;
      c.point_P = Vec3(1e-3 * node, 0, node % 10);
      c.barycentric = Vec3::UnitX();
      append_contact(c, {node, node + 1, node + 2}, found);
    }
    ContactSet result;
    reduce_contacts(found, false, limits, result);
    CHECK(result.faces.size() <= limits.faces);
    CHECK(result.face_nodes.size() <= limits.face_nodes);
    CHECK(result.contacts.size() <= limits.contacts);
    CHECK(result.deepest_gap() == 0);
    return result;
  };
  CHECK_FALSE(reduced({1024, 10, 400}).truncated);
  for (const ContactLimits& limits : {ContactLimits{240, 10, 199}, {240, 4, 400}, {240, 10, 160}}) {
    const ContactSet all = reduced(limits);
    CHECK_FALSE(all.truncated);
    CHECK(all.faces.size() == 4);
    CHECK(all.count() == 400);
  }
  CHECK(reduced({239, 10, 199}).truncated);
  CHECK(reduced({10, 0, 0}).truncated);
}

TEST_CASE("contact reduction: of a round probe the deepest and a spread remain, of each organ") {
  // Oracle: brute force: sorted gaps, and how far from a kept one any contact is. Very many are
  // thinned first, to one in each cell of a grid.
  RandomShapes random(84);
  for (const std::uint32_t of_each : {190u, 2000u}) {
    std::vector<FoundContact> found;
    for (std::uint32_t t = 0; t < 2 * of_each; ++t) {
      FoundContact c = contact(t % 2, t, {0.2, 0.3, 0.5}, 0);
      c.point_P = random.point(1);
      c.normal_P = random.direction();
      c.gap = c.organ == 1 ? random.number(2, 3) : random.number(-1, 1);
      append_contact(c, {3 * t, 3 * t + 1, 3 * t + 2}, found);
    }
    const auto all = found;
    ContactSet result;
    reduce_contacts(found, true, kMost, result);
    CHECK_FALSE(result.truncated);  // deformation finds the rest around them
    CHECK(result.contacts.size() == 2 * kMostOfRound);
    const auto tissue = [](const Contact& c) -> Vec3 { return c.point_P - c.gap * c.normal_P; };
    for (const std::uint32_t organ : {0u, 1u}) {
      std::vector<double> gaps, kept;
      double farthest = 0;
      Bounds box;
      for (const FoundContact& c : all) {
        if (c.organ != organ) continue;
        gaps.push_back(c.gap);
        box.add(tissue(c));
        double nearest = 1e300;
        for (const Contact& k : result.contacts) {
          if (k.organ == organ) nearest = std::min(nearest, (tissue(k) - tissue(c)).norm());
        }
        farthest = std::max(farthest, nearest);
      }
      for (const Contact& k : result.contacts) {
        if (k.organ == organ) kept.push_back(k.gap);
      }
      std::sort(gaps.begin(), gaps.end());
      std::sort(kept.begin(), kept.end());
      REQUIRE(kept.size() == kMostOfRound);
      CHECK(std::equal(kept.begin(), kept.begin() + kMostOfRound / 2, gaps.begin()));
      // Gonzalez 1985: each of the others was farther from all kept than any that is left out is
      // now; one that was thinned out is no farther than a cell from one that was not.
      const double cell = of_each > kMostThinned ? (box.upper - box.lower).norm() / 4 : 0;
      for (const Contact& k : result.contacts) {
        if (k.organ != organ || k.gap <= kept[kMostOfRound / 2 - 1]) continue;
        for (const Contact& other : result.contacts) {
          if (other.organ != organ || other.triangle == k.triangle) continue;
          CHECK((tissue(k) - tissue(other)).norm() + cell >= farthest);
        }
      }
    }
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
  reduce_contacts(found, false, kMost, result);
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

TEST_CASE("contact reduction: what is left of very many holds all that is chosen from them") {
  // Oracle: the same reduction of all.
  RandomShapes random(83);
  for (const double ahead : {0.0, 0.004}) {
    const ProbeReach reach{{0, 0, -ahead}, 3 * ahead + 0.002};
    const ContactLimits limits{200, 10, 500, 900};
    std::vector<FoundContact> found;
    for (int i = 0; i < 6000; ++i) {
      FoundContact c = contact(0, static_cast<std::uint32_t>(random.number(0, 700)), {1, 0, 0},
                               random.number(-0.001, 0.02));
      c.point_P = random.point(0.01);
      c.normal_P = random.direction();
      append_contact(c, {c.triangle, 1000, 1001}, found);
      if (random.number(0, 1) < 0.1) found.push_back(found[found.size() / 2]);  // found twice
    }
    std::vector<FoundContact> left = found;
    constexpr std::size_t kFirst = 500;
    leave_choice(left, kFirst, limits, reach);
    CHECK(left.size() < found.size() / 2);
    ContactSet of_all, of_left;
    reduce_contacts(found, false, limits, of_all, reach);
    reduce_contacts(left, false, limits, of_left, reach);
    CHECK(of_all.truncated == of_left.truncated);
    REQUIRE(of_all.contacts.size() == of_left.contacts.size());
    for (std::size_t i = 0; i < of_all.contacts.size(); ++i) {
      CHECK(of_all.contacts[i].point_P == of_left.contacts[i].point_P);
    }
  }
}

}  // namespace palpate::collision
