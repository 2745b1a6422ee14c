#include "collision/edge_contacts.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "modules/core/tolerances.h"
#include "modules/geometry/continuous_collision.h"

namespace palpate::collision {
namespace {

constexpr double kParallel = 1e-6;   // sine between edges
constexpr double kInside = 1e-9;     // of the edge's length
constexpr double kConeSlack = 0.02;  // sine

/// Both edges at one time, and, for those near enough to need it, which way the organ's faces.
struct Edges {
  Vec3 a0, a1;  ///< probe's
  Vec3 b0, b1;  ///< organ's
  Vec3 outward;

  geometry::SegmentPair closest() const { return geometry::closest_of_segments(a0, a1, b0, b1); }
  /// Unit common perpendicular on the organ's outer side; zero if parallel.
  Vec3 perpendicular() const {
    const Vec3 normal = (a1 - a0).cross(b1 - b0);
    if (normal.norm() <= kParallel * (a1 - a0).norm() * (b1 - b0).norm()) return Vec3::Zero();
    return normal.dot(outward) < 0 ? Vec3(-normal.normalized()) : normal.normalized();
  }
  /// Height of the probe's edge over the organ's along the perpendicular, the same anywhere on
  /// them.
  double height() const { return perpendicular().dot(a0 - b0); }
};

bool opposes(const SharpEdge& sharp, const Vec3& normal) {
  return normal.dot(sharp.face_normals[0] + sharp.face_normals[1]) < 0;
}

bool is_inside(const geometry::SegmentPair& pair) {
  return std::min({pair.s, pair.t, 1 - pair.s, 1 - pair.t}) > kInside;
}

Edges edges_at_start(const OrganStep& step, const SharpMesh& probe, const EdgePair& pair) {
  const auto& vertices = probe.edges()[pair.first].vertices;
  const auto& nodes = step.organ.edges()[pair.second].nodes;
  return {probe.vertices()[vertices[0]], probe.vertices()[vertices[1]], step.node_start(nodes[0]),
          step.node_start(nodes[1]), Vec3::Zero()};
}

Edges edges_at_end(const OrganStep& step, const SharpMesh& probe, const EdgePair& pair) {
  const auto& vertices = probe.edges()[pair.first].vertices;
  const auto& nodes = step.organ.edges()[pair.second].nodes;
  return {probe.vertices()[vertices[0]], probe.vertices()[vertices[1]], step.node_end(nodes[0]),
          step.node_end(nodes[1]), Vec3::Zero()};
}

/// Is the organ's edge, seen along `apart` (tissue to probe, unit), nearer than its triangles?
bool is_ridge(const OrganStep& step, const EdgePair& pair, const Edges& edges, const Vec3& apart) {
  const SurfaceEdge& edge = step.organ.edges()[pair.second];
  for (const std::uint32_t t : edge.triangles) {
    for (const std::uint32_t node : step.organ.triangles()[t]) {
      if (node == edge.nodes[0] || node == edge.nodes[1]) continue;
      const Vec3 along = (edges.b1 - edges.b0).normalized(), in = step.node_end(node) - edges.b0;
      const Vec3 into_triangle = (in - along * along.dot(in)).normalized();
      if (apart.dot(into_triangle) > kConeSlack) return false;
    }
  }
  return true;
}

/// Unit, from the organ's edge to the probe's; of edges that touch their perpendicular.
Vec3 direction_between(const Edges& edges, const geometry::SegmentPair& at) {
  const Vec3 apart = at.on_first - at.on_second;
  const double distance = apart.norm();
  return distance < kDirectionless ? edges.perpendicular() : Vec3(apart / distance);
}

/// @param apart  direction_between() them
bool in_front(const OrganStep& step, const SharpEdge& sharp, const EdgePair& pair,
              const Edges& edges, const Vec3& apart) {
  if (apart.dot(edges.outward) <= 0) return false;
  for (const Vec3& into : sharp.into_face) {
    if (-apart.dot(into) > kConeSlack) return false;
  }
  return is_ridge(step, pair, edges, apart);
}

std::optional<geometry::Impact> impact_of(const Edges& start, const Edges& end, double separation) {
  return geometry::edge_edge_impact({start.a0, start.a1, start.b0, start.b1},
                                    {end.a0, end.a1, end.b0, end.b1}, separation);
}

/// Contact with the organ's edge at fraction t.
void append_edge_contact(const OrganStep& step, std::uint32_t edge_index, double t,
                         FoundContact contact, std::vector<FoundContact>& found) {
  const SurfaceEdge& edge = step.organ.edges()[edge_index];
  contact.organ = step.organ_index;
  contact.triangle = edge.triangles[0];
  const geometry::Triangle& nodes = step.organ.triangles()[contact.triangle];
  contact.barycentric = Vec3::Zero();
  contact.barycentric[std::find(nodes.begin(), nodes.end(), edge.nodes[0]) - nodes.begin()] = 1 - t;
  contact.barycentric[std::find(nodes.begin(), nodes.end(), edge.nodes[1]) - nodes.begin()] = t;
  append_contact(contact, nodes, found);
}

}  // namespace

void EdgeContacts::reset() {
  before_.clear();
  now_.clear();
}

void EdgeContacts::change_surface(const SurfaceChange& change) {
  for (Crossed& crossed : now_) {
    if (crossed.organ == change.organ) crossed.pair.second = change.edge(crossed.pair.second);
  }
}

void EdgeContacts::begin_step() {
  before_.swap(now_);
  now_.clear();
  std::sort(before_.begin(), before_.end(), [](const Crossed& a, const Crossed& b) {
    return std::tie(a.organ, a.pair) < std::tie(b.organ, b.pair);
  });
}

const EdgeContacts::Crossed* EdgeContacts::remembered(std::uint32_t organ,
                                                      const EdgePair& pair) const {
  const auto key = std::tie(organ, pair);
  const auto at = std::lower_bound(
      before_.begin(), before_.end(), key,
      [](const Crossed& c, const auto& k) { return std::tie(c.organ, c.pair) < k; });
  return at != before_.end() && std::tie(at->organ, at->pair) == key ? &*at : nullptr;
}

void EdgeContacts::append_remembered(std::uint32_t organ, std::vector<EdgePair>& pairs) const {
  for (const Crossed& crossed : before_) {
    if (crossed.organ == organ) pairs.push_back(crossed.pair);
  }
}

void EdgeContacts::find(const OrganStep& step, const SharpMesh& probe,
                        std::span<const EdgePair> pairs, std::vector<FoundContact>& found) {
  for (const EdgePair& pair : pairs) find_pair(step, probe, pair, found);
}

void EdgeContacts::find_pair(const OrganStep& step, const SharpMesh& probe, const EdgePair& pair,
                             std::vector<FoundContact>& found) {
  Edges start = edges_at_start(step, probe, pair), end = edges_at_end(step, probe, pair);
  const SharpEdge& sharp = probe.edges()[pair.first];
  const geometry::SegmentPair at = end.closest();
  const double distance = (at.on_first - at.on_second).norm();
  const double travel = std::max((end.b0 - start.b0).norm(), (end.b1 - start.b1).norm());
  const double separation = step.motion.chord_error();
  const bool may_cross = distance <= travel + separation + kDirectionless;
  const Crossed* crossed = remembered(step.organ_index, pair);
  if (distance > step.margin && !may_cross && crossed == nullptr) return;
  start.outward = step.edge_normal_start(pair.second);
  end.outward = step.edge_normal_end(pair.second);
  const auto impact = may_cross ? impact_of(start, end, separation) : std::nullopt;
  FoundContact contact;
  contact.normal_P = end.perpendicular();
  const bool is_behind = end.height() <= 0 && opposes(sharp, contact.normal_P);
  if (is_behind && (crossed != nullptr || (impact && start.height() > 0))) {
    const double limit = crossed != nullptr ? crossed->depth_limit : step.depth_limit;
    if (is_inside(at) && -end.height() <= limit) {
      contact.point_P = at.on_first;
      contact.gap = end.height();
      append_edge_contact(step, pair.second, at.t, contact, found);
      now_.push_back({step.organ_index, pair, limit});
    } else if (impact) {
      // The edges have slid off each other: the contact of the crossing is carried to the end.
      contact.point_P = end.a0 + impact->u * (end.a1 - end.a0);
      contact.gap = end.height();
      append_edge_contact(step, pair.second, impact->v, contact, found);
    }
    return;
  }
  if (distance > step.margin || !is_inside(at)) return;
  contact.normal_P = direction_between(end, at);
  if (!in_front(step, sharp, pair, end, contact.normal_P)) return;
  contact.point_P = at.on_first;
  contact.gap = distance;
  append_edge_contact(step, pair.second, at.t, contact, found);
}

}  // namespace palpate::collision
