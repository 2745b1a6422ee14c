#include "modules/geometry/bisection.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "modules/core/error.h"

namespace palpate::geometry {
namespace {

/// Of a tree; one that has grown beyond it is planted again.
constexpr std::size_t kMostTetrahedraKept = 400'000;
constexpr double kSizeRounding = 1e-9;

/// The corner opposite each of kTetrahedronFaces.
constexpr std::array<int, 4> kOpposite{3, 2, 0, 1};

using Place = std::tuple<double, double, double>;

Place place_of(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

}  // namespace

BisectionTree::BisectionTree(TetMesh mesh)
    : coarse_(std::move(mesh)), coarse_outer_(coarse_.tetrahedra.size(), 0) {
  for (const BoundaryTriangle& triangle : boundary_triangles(coarse_)) {
    coarse_outer_[triangle.tetrahedron] |=
        static_cast<std::uint8_t>(1 << kOpposite[static_cast<std::size_t>(triangle.face)]);
  }
  plant();
}

void BisectionTree::plant() {
  nodes_.clear();
  edges_.clear();
  halved_in_.clear();
  tetrahedra_.clear();
  edge_numbers_.clear();
  leaves_.clear();
  choice_ = 0;
  nodes_chosen_ = coarse_.nodes.size();
  for (const Vec3& place : coarse_.nodes) nodes_.push_back({place, {kNone, kNone}});
  for (std::size_t t = 0; t < coarse_.tetrahedra.size(); ++t) {
    leaves_.push_back(static_cast<std::uint32_t>(t));
    add(coarse_.tetrahedra[t], coarse_outer_[t], 0);
  }
}

void BisectionTree::add(const Tetrahedron& corners, std::uint8_t outer, std::uint8_t halvings) {
  Tet tet;
  tet.corners = corners;
  tet.outer = outer;
  tet.halvings = halvings;
  for (std::size_t e = 0; e < kTetrahedronEdges.size(); ++e) {
    const auto& [i, j] = kTetrahedronEdges[e];
    tet.edges[e] =
        edge_between(corners[static_cast<std::size_t>(i)], corners[static_cast<std::size_t>(j)]);
  }
  tet.longest = longest_of(tet);
  tetrahedra_.push_back(tet);
}

std::uint32_t BisectionTree::edge_between(std::uint32_t a, std::uint32_t b) {
  if (a > b) std::swap(a, b);
  const auto [at, is_new] = edge_numbers_.try_emplace(std::uint64_t{a} << 32 | b,
                                                      static_cast<std::uint32_t>(edges_.size()));
  if (is_new) {
    Edge edge;
    edge.a = a;
    edge.b = b;
    edge.squared_length = (nodes_[a].place - nodes_[b].place).squaredNorm();
    edges_.push_back(edge);
    halved_in_.push_back(0);
  }
  return at->second;
}

bool BisectionTree::comes_first(const Edge& a, const Edge& b) const {
  const auto ends = [&](const Edge& edge) {
    const Place p = place_of(nodes_[edge.a].place), q = place_of(nodes_[edge.b].place);
    return std::pair(std::min(p, q), std::max(p, q));
  };
  return ends(a) < ends(b);
}

std::uint8_t BisectionTree::longest_of(const Tet& tet) const {
  std::uint8_t longest = 0;
  for (std::uint8_t e = 1; e < 6; ++e) {
    const Edge &edge = edges_[tet.edges[e]], &best = edges_[tet.edges[longest]];
    if (edge.squared_length < best.squared_length) continue;
    if (edge.squared_length > best.squared_length || comes_first(edge, best)) longest = e;
  }
  return longest;
}

void BisectionTree::halve(std::uint32_t number) {
  const Tet tet = tetrahedra_[number];
  Edge& edge = edges_[tet.edges[tet.longest]];
  if (edge.middle == kNone) {
    edge.middle = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({(nodes_[edge.a].place + nodes_[edge.b].place) / 2, {edge.a, edge.b}});
  }
  const std::uint32_t middle = edge.middle;
  tetrahedra_[number].halves = static_cast<std::uint32_t>(tetrahedra_.size());
  const auto& ends = kTetrahedronEdges[tet.longest];
  for (const int given : {ends[1], ends[0]}) {
    const int kept = ends[0] + ends[1] - given;
    Tetrahedron corners = tet.corners;
    corners[static_cast<std::size_t>(given)] = middle;
    // Opposite the end that is kept lies the new face between both halves.
    add(corners, static_cast<std::uint8_t>(tet.outer & ~(1 << kept)),
        static_cast<std::uint8_t>(tet.halvings + 1));
  }
}

bool BisectionTree::is_too_large(const Tet& tet, const Wanted& wanted) {
  Vec3 mean = Vec3::Zero();
  for (const auto node : tet.corners) mean += nodes_[node].place / 4;
  const double at_mean = wanted.size(mean);
  const double longest = edges_[tet.edges[tet.longest]].squared_length;
  if (longest > at_mean * at_mean) return true;
  // No edge's middle is further from the mean than half the longest edge.
  if (std::sqrt(longest) * (1 + wanted.growth / 2) < (1 - kSizeRounding) * at_mean) return false;
  for (const std::uint32_t e : tet.edges) {
    Edge& edge = edges_[e];
    if (edge.sized_in != choice_) {
      const double allowed = wanted.size((nodes_[edge.a].place + nodes_[edge.b].place) / 2);
      edge.too_long = edge.squared_length > allowed * allowed;
      edge.sized_in = choice_;
    }
    if (edge.too_long) return true;
  }
  return false;
}

bool BisectionTree::lost_an_edge(const Tet& tet) const {
  return std::ranges::any_of(tet.edges, [&](std::uint32_t e) { return halved_in_[e] == choice_; });
}

/// Children take their parent's place in the order.
/// @param is_small_enough  its sizes were looked at
/// @returns false if there are too many nodes
bool BisectionTree::append_leaves(std::uint32_t number, bool is_small_enough,
                                  const Wanted& wanted) {
  is_small_enough = is_small_enough || !is_too_large(tetrahedra_[number], wanted);
  if (is_small_enough && !lost_an_edge(tetrahedra_[number])) {
    next_leaves_.push_back(number);
    return true;
  }
  if (tetrahedra_[number].halves == kNone) halve(number);
  const Tet& tet = tetrahedra_[number];
  std::uint32_t& halved_in = halved_in_[tet.edges[tet.longest]];
  if (halved_in != choice_) {
    halved_in = choice_;
    if (++nodes_chosen_ > wanted.most_nodes) return false;
  }
  const std::uint32_t first = tet.halves;
  return append_leaves(first, false, wanted) && append_leaves(first + 1, false, wanted);
}

bool BisectionTree::choose(const SizeField& size, double growth, std::size_t most_nodes) {
  const Wanted wanted{size, growth, most_nodes};
  if (tetrahedra_.size() > kMostTetrahedraKept) plant();
  ++choice_;
  nodes_chosen_ = coarse_.nodes.size();
  leaves_.resize(coarse_.tetrahedra.size());
  for (std::uint32_t t = 0; t < leaves_.size(); ++t) leaves_[t] = t;
  bool looked_at = false, any = true;
  while (any) {
    next_leaves_.clear();
    for (const std::uint32_t leaf : leaves_) {
      if (append_leaves(leaf, looked_at, wanted)) continue;
      leaves_.clear();
      return false;
    }
    any = next_leaves_.size() > leaves_.size();
    looked_at = true;
    std::swap(leaves_, next_leaves_);
  }
  return true;
}

std::size_t BisectionTree::boundary_count() const {
  std::size_t count = 0;
  for (const std::uint32_t leaf : leaves_) {
    count += static_cast<std::size_t>(std::popcount(tetrahedra_[leaf].outer));
  }
  return count;
}

HalvedMesh BisectionTree::mesh() const {
  HalvedMesh result;
  TetMesh& mesh = result.mesh;
  mesh.nodes = coarse_.nodes;
  mesh.tetrahedra.reserve(leaves_.size());
  std::vector<std::uint32_t> numbers(nodes_.size(), kNone), chosen;
  for (std::uint32_t i = 0; i < mesh.nodes.size(); ++i) {
    numbers[i] = i;
    chosen.push_back(i);
  }
  for (const std::uint32_t leaf : leaves_) {
    // Numbered as the tetrahedra come to them: by the tree, not by what was chosen before.
    Tetrahedron corners = tetrahedra_[leaf].corners;
    for (std::uint32_t& node : corners) {
      if (numbers[node] == kNone) {
        numbers[node] = static_cast<std::uint32_t>(mesh.nodes.size());
        mesh.nodes.push_back(nodes_[node].place);
        chosen.push_back(node);
      }
      node = numbers[node];
    }
    for (int face = 0; face < 4; ++face) {
      if ((tetrahedra_[leaf].outer & 1 << kOpposite[static_cast<std::size_t>(face)]) == 0) continue;
      BoundaryTriangle triangle{{}, static_cast<std::uint32_t>(mesh.tetrahedra.size()), face};
      for (std::size_t k = 0; k < 3; ++k) {
        triangle.nodes[k] =
            corners[static_cast<std::size_t>(kTetrahedronFaces[static_cast<std::size_t>(face)][k])];
      }
      result.boundary.push_back(triangle);
    }
    mesh.tetrahedra.push_back(corners);
    result.halvings.push_back(tetrahedra_[leaf].halvings);
  }
  for (const std::uint32_t node : chosen) {
    HalvedMesh::Parents parents = nodes_[node].parents;
    if (parents[0] != kNone) {
      const auto [low, high] = std::minmax(numbers[parents[0]], numbers[parents[1]]);
      parents = {low, high};
    }
    result.parents.push_back(parents);
  }
  return result;
}

TetMesh bisected(const TetMesh& mesh, const SizeField& size, std::size_t most_nodes) {
  BisectionTree tree(mesh);
  if (!tree.choose(size, std::numeric_limits<double>::infinity(), most_nodes)) {
    throw InputError("refined, it would have more than " + std::to_string(most_nodes) +
                     " nodes; allow longer edges or let them grow faster");
  }
  return tree.mesh().mesh;
}

}  // namespace palpate::geometry
