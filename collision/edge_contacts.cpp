#include "collision/edge_contacts.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "modules/core/sort_unique.h"
#include "modules/core/tolerances.h"
#include "modules/geometry/continuous_collision.h"

namespace palpate::collision {
namespace {

constexpr double kParallel = 1e-6;  // sine between edges
constexpr double kInside = 1e-9;    // of the edge's length

/// Both edges at one time, and which way the organ's faces.
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

/// Is the organ's edge, seen along `apart` (tissue to probe, unit), nearer than its triangles?
bool is_ridge(const OrganStep& step, const SurfaceEdge& edge, const Edges& edges,
              const Vec3& apart) {
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
bool in_front(const OrganStep& step, const SharpEdge& sharp, const SurfaceEdge& edge,
              const Edges& edges, const Vec3& apart) {
  if (apart.dot(edges.outward) <= 0) return false;
  for (const Vec3& into : sharp.into_face) {
    if (-apart.dot(into) > kConeSlack) return false;
  }
  return is_ridge(step, edge, edges, apart);
}

/// Most that are near are apart, all the time, along the direction between them at the end.
std::optional<geometry::Impact> impact_of(const Edges& start, const Edges& end,
                                          const geometry::SegmentPair& at_end, double separation) {
  const geometry::FourPoints from{start.a0, start.a1, start.b0, start.b1};
  const geometry::FourPoints to{end.a0, end.a1, end.b0, end.b1};
  const Vec3 apart = (at_end.on_second - at_end.on_first).normalized();
  const double least = 2 * separation + geometry::kImpactTolerance;
  if (geometry::gap_along(apart, 2, to) > least && geometry::gap_along(apart, 2, from) > least) {
    return {};
  }
  return geometry::edge_edge_impact(from, to, separation);
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

auto place_of(std::uint32_t organ, const EdgePair& pair) {
  return std::tuple(organ, pair.second, pair.first);
}

}  // namespace

/// Where it is in the step, and where a probe's edge may touch it.
class EdgeContacts::OrganEdge {
 public:
  OrganEdge(const OrganStep& in, std::uint32_t of_organ)
      : step(in), index(of_organ), edge(in.organ.edges()[of_organ]) {
    const auto& [a, b] = edge.nodes;
    start_ = {step.node_start(a), step.node_start(b)};
    end_ = {step.node_end(a), step.node_end(b)};
    outward_start_ = step.edge_normal_start(index);
    outward_end_ = step.edge_normal_end(index);
    travel = std::max((end_[0] - start_[0]).norm(), (end_[1] - start_[1]).norm());
  }

  Edges with_start(const SharpMesh& probe, const SharpEdge& sharp) const {
    return with(probe, sharp, start_, outward_start_);
  }
  Edges with_end(const SharpMesh& probe, const SharpEdge& sharp) const {
    return with(probe, sharp, end_, outward_end_);
  }

  /// All of its way.
  Bounds way() const {
    Bounds box = at_end();
    for (const Vec3& x : start_) box.add(x);
    return box;
  }
  Bounds at_end() const {
    Bounds box;
    for (const Vec3& x : end_) box.add(x);
    return box;
  }
  /// The directions that it faces at the end.
  NormalCone cone_at_end() const {
    SweptTriangle one, other;
    const auto& [first, second] = edge.triangles;
    if (first == second || !step.sweep(first, one) || !step.sweep(second, other)) return {};
    Vec3 into = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t node = other.nodes[k];
      if (node != edge.nodes[0] && node != edge.nodes[1]) into = other.end[k] - end_[0];
    }
    return cone_of_edge(one.normal_end, other.normal_end, into);
  }

  const OrganStep& step;
  const std::uint32_t index;
  const SurfaceEdge& edge;
  double travel = 0;  ///< the larger one of its ends' [m]

 private:
  static Edges with(const SharpMesh& probe, const SharpEdge& sharp, const std::array<Vec3, 2>& ends,
                    const Vec3& outward) {
    return {probe.vertices()[sharp.vertices[0]], probe.vertices()[sharp.vertices[1]], ends[0],
            ends[1], outward};
  }

  std::array<Vec3, 2> start_, end_;
  Vec3 outward_start_, outward_end_;
};

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
  std::ranges::sort(before_, {}, [](const Crossed& c) { return place_of(c.organ, c.pair); });
}

std::span<const EdgeContacts::Crossed> EdgeContacts::remembered(std::uint32_t organ,
                                                                std::uint32_t edge) const {
  return std::ranges::equal_range(before_, std::pair(organ, edge), {}, [](const Crossed& c) {
    return std::pair(c.organ, c.pair.second);
  });
}

void EdgeContacts::append_remembered(std::uint32_t organ, std::vector<std::uint32_t>& edges) const {
  for (const Crossed& crossed : before_) {
    if (crossed.organ == organ) edges.push_back(crossed.pair.second);
  }
}

/// near_ of an edge, each once: what it may pass through, what is ahead and it may touch from the
/// front, and what is remembered.
void EdgeContacts::list_near(const OrganEdge& edge, const SharpMesh& probe, const Ahead& ahead) {
  const OrganStep& step = edge.step;
  Bounds passed = edge.way(), near = edge.at_end();
  passed.inflate(step.motion.chord_error() + geometry::kImpactTolerance + kDirectionless);
  near.add(near.lower - ahead.way_P);
  near.add(near.upper - ahead.way_P);
  near.inflate(ahead.beside);
  near_.clear();
  probe.append_edges(passed, near, edge.cone_at_end(), near_);
  const auto before = remembered(step.organ_index, edge.index);
  if (before.empty()) return;
  for (const Crossed& crossed : before) near_.push_back(crossed.pair.first);
  sort_unique(near_);
}

/// @returns of how many edges: where pairs are too many not of all
std::size_t EdgeContacts::list_pairs_within(const OrganStep& step, const SharpMesh& probe,
                                            std::span<const std::uint32_t> edges,
                                            const Ahead& ahead) {
  pairs_.clear();
  for (std::size_t i = 0; i < edges.size(); ++i) {
    list_near(OrganEdge(step, edges[i]), probe, ahead);
    if (pairs_.size() + near_.size() > kMostPairs) return i;
    for (const std::uint32_t of_probe : near_) pairs_.push_back({edges[i], of_probe});
  }
  return edges.size();
}

EdgeContacts::Searched EdgeContacts::list_pairs(const OrganStep& step, const SharpMesh& probe,
                                                const ProbeReach& reach,
                                                std::span<const std::uint32_t> edges) {
  const Ahead all{Vec3::Zero(), step.margin};
  const Ahead straight_on{reach.ahead_P, reach.sideways()};
  const Ahead close{Vec3::Zero(), reach.sideways() / 4};
  if (list_pairs_within(step, probe, edges, all) == edges.size()) return Searched::kAll;
  std::size_t listed = 0;
  for (const Ahead& less : {straight_on, close, Ahead{}}) {
    listed = list_pairs_within(step, probe, edges, less);
    if (listed == edges.size()) return Searched::kLessAhead;
  }
  for (const Crossed& crossed : before_) {
    if (crossed.organ != step.organ_index || crossed.pair.second < edges[listed]) continue;
    pairs_.push_back({crossed.pair.second, crossed.pair.first});
  }
  return Searched::kPart;
}

EdgeContacts::Searched EdgeContacts::find(const OrganStep& step, const SharpMesh& probe,
                                          const ProbeReach& reach,
                                          std::span<const std::uint32_t> edges,
                                          std::vector<FoundContact>& found) {
  const Searched searched = list_pairs(step, probe, reach, edges);
  for (auto first = pairs_.begin(); first != pairs_.end();) {
    const OrganEdge edge(step, first->first);
    for (; first != pairs_.end() && first->first == edge.index; ++first) {
      find_pair(edge, probe, first->second, found);
    }
  }
  return searched;
}

void EdgeContacts::find_pair(const OrganEdge& edge, const SharpMesh& probe, std::uint32_t of_probe,
                             std::vector<FoundContact>& found) {
  const OrganStep& step = edge.step;
  const EdgePair pair{of_probe, edge.index};
  const SharpEdge& sharp = probe.edges()[of_probe];
  const Edges end = edge.with_end(probe, sharp);
  const geometry::SegmentPair at = end.closest();
  const double distance = (at.on_first - at.on_second).norm();
  const double separation = step.motion.chord_error();
  const bool may_cross = distance <= edge.travel + separation + kDirectionless;
  const auto before = remembered(step.organ_index, edge.index);
  const auto crossed = std::ranges::find(before, pair, &Crossed::pair);
  const bool was_crossed = crossed != before.end();
  if (distance > step.margin && !may_cross && !was_crossed) return;
  const Edges start = edge.with_start(probe, sharp);
  const auto impact = may_cross ? impact_of(start, end, at, separation) : std::nullopt;
  FoundContact contact;
  contact.normal_P = end.perpendicular();
  const bool is_behind = end.height() <= 0 && opposes(sharp, contact.normal_P);
  if (is_behind && (was_crossed || (impact && start.height() > 0))) {
    const double limit = was_crossed ? crossed->depth_limit : step.depth_limit;
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
  if (!in_front(step, sharp, edge.edge, end, contact.normal_P)) return;
  contact.point_P = at.on_first;
  contact.gap = distance;
  append_edge_contact(step, pair.second, at.t, contact, found);
}

}  // namespace palpate::collision
