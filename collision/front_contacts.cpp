#include "collision/front_contacts.h"

#include <algorithm>
#include <cmath>

#include "collision/core_wall.h"
#include "collision/thinning.h"

namespace palpate::collision {
namespace {

/// A degenerate triangle has no front.
bool is_in_front(const Vec3& x, const geometry::TriangleCorners& triangle) {
  constexpr double kSurelyLarge = 1e-20;  // of sides to the fourth: squared, see unit_normal()
  const Vec3 ab = triangle[1] - triangle[0], ac = triangle[2] - triangle[0];
  const Vec3 normal = ab.cross(ac);
  const double sides = ab.squaredNorm() + ac.squaredNorm();
  return normal.dot(x - triangle[0]) > 0 && (normal.squaredNorm() > kSurelyLarge * sides * sides ||
                                             !geometry::unit_normal(triangle).isZero(0));
}

geometry::Triangle nodes_of(const NearSurface& near, const NearSurface::Candidate& candidate) {
  const auto& [a, b, c] = candidate.corners;
  const auto nodes = near.candidate_nodes();
  return {nodes[a].index, nodes[b].index, nodes[c].index};
}

geometry::TriangleCorners ends_of(const NearSurface& near,
                                  const NearSurface::Candidate& candidate) {
  const auto& [a, b, c] = candidate.corners;
  const auto nodes = near.candidate_nodes();
  return {nodes[a].end, nodes[b].end, nodes[c].end};
}

}  // namespace

bool FrontContacts::find(const OrganStep& step, const Core& ball, const NearSurface& near,
                         std::vector<FoundContact>& found) {
  const Vec3& centre = ball.a;
  const double travel = near.candidate_travel();
  const double may_meet = std::max(travel + step.motion.chord_error(), kSteadyDistance);
  const double in_front = ball.radius + step.margin, grazed = ball.radius + travel;
  nearest_.clear();
  maybe_grazed_.clear();
  places_.begin();
  for (std::uint32_t i = 0; i < near.candidates().size(); ++i) {
    const NearSurface::Candidate& candidate = near.candidates()[i];
    const geometry::TriangleCorners ends = ends_of(near, candidate);
    const auto at = geometry::closest_on_triangle(centre, ends);
    const double distance = (centre - at.point).norm();
    if (std::isnan(distance)) continue;  // no area: its sides are those of others
    if (distance <= may_meet) return false;
    if (distance <= in_front && is_in_front(centre, ends)) {
      add({distance, at.point.cast<float>(), candidate.triangle, i, kNoGraze}, at.weights,
          nodes_of(near, candidate));
    } else if (distance <= grazed) {
      maybe_grazed_.push_back(candidate.triangle);
    }
  }
  add_grazes(step, ball);
  append(step, ball, near, found);
  return true;
}

/// Of triangles that share the place the lowest names it.
void FrontContacts::add(const Nearest& nearest, const Vec3& weights,
                        const geometry::Triangle& nodes) {
  if (const auto place = node_or_edge(weights, nodes)) {
    const auto index = static_cast<std::uint32_t>(nearest_.size());
    const std::uint32_t before = places_.add(*place, index);
    if (before != IndexMarks::kNone) {
      if (nearest.triangle < nearest_[before].triangle) nearest_[before] = nearest;
      return;
    }
  }
  nearest_.push_back(nearest);
}

void FrontContacts::append(const OrganStep& step, const Core& ball, const NearSurface& near,
                           std::vector<FoundContact>& found) {
  thin(
      nearest_,
      [](const Nearest& a, const Nearest& b) {
        return a.distance != b.distance ? a.distance < b.distance : a.triangle < b.triangle;
      },
      [](const Nearest& one) -> Vec3 { return one.place.cast<double>(); });
  for (const Nearest& one : nearest_) {
    if (one.graze != kNoGraze) {
      found.push_back(grazes_[one.graze]);
      continue;
    }
    const NearSurface::Candidate& candidate = near.candidates()[one.candidate];
    const auto at = geometry::closest_on_triangle(ball.a, ends_of(near, candidate));
    append_front(step, ball, {ball.a, at, one.distance}, one.triangle, nodes_of(near, candidate),
                 Vec3::Zero(), found);
  }
}

void FrontContacts::add_grazes(const OrganStep& step, const Core& ball) {
  grazes_.clear();
  SweptTriangle swept;
  for (const std::uint32_t triangle : maybe_grazed_) {
    if (step.sweep(triangle, swept)) append_graze(step, ball, CoreCandidate(ball, swept), grazes_);
  }
  for (std::uint32_t i = 0; i < grazes_.size(); ++i) {
    const FoundContact& graze = grazes_[i];
    const Vec3 tissue = graze.point_P - graze.gap * graze.normal_P;
    nearest_.push_back({ball.radius + graze.gap, tissue.cast<float>(), graze.triangle, 0, i});
  }
}

}  // namespace palpate::collision
