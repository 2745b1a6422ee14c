#include "modules/geometry/bisection.h"

#include <algorithm>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "modules/core/error.h"

namespace palpate::geometry {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
constexpr std::uint32_t kNone = ~std::uint32_t{0};

struct PairHash {
  std::size_t operator()(const Edge& edge) const {
    return std::hash<std::uint64_t>()(std::uint64_t{edge.first} << 32 | edge.second);
  }
};

class Bisection {
 public:
  Bisection(const TetMesh& mesh, const SizeField& size, std::size_t most_nodes)
      : nodes_(mesh.nodes), size_(size), most_nodes_(most_nodes) {
    leaves_.reserve(mesh.tetrahedra.size());
    for (const Tetrahedron& t : mesh.tetrahedra) leaves_.push_back({t, false});
  }

  /// Once over all leaves; children take their parent's place in the order.
  /// @returns false if nothing was left to halve
  bool sweep() {
    const std::size_t before = leaves_.size();
    std::vector<Leaf> next;
    next.reserve(before);
    for (const Leaf& leaf : leaves_) append_leaves(leaf, next);
    leaves_ = std::move(next);
    return leaves_.size() > before;
  }

  /// New nodes are numbered as the tetrahedra come to them: by the tree, not by the sweeps.
  TetMesh mesh(std::size_t kept) const {
    TetMesh result;
    result.nodes.assign(nodes_.begin(), nodes_.begin() + static_cast<std::ptrdiff_t>(kept));
    std::vector<std::uint32_t> numbers(nodes_.size(), kNone);
    for (std::uint32_t i = 0; i < kept; ++i) numbers[i] = i;
    result.tetrahedra.reserve(leaves_.size());
    for (const Leaf& leaf : leaves_) {
      Tetrahedron t = leaf.corners;
      for (std::uint32_t& node : t) {
        if (numbers[node] == kNone) {
          numbers[node] = static_cast<std::uint32_t>(result.nodes.size());
          result.nodes.push_back(nodes_[node]);
        }
        node = numbers[node];
      }
      result.tetrahedra.push_back(t);
    }
    return result;
  }

 private:
  struct Leaf {
    Tetrahedron corners;
    bool is_small_enough;  ///< its sizes were looked at
  };

  static Edge edge_of(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }

  using Place = std::tuple<double, double, double>;

  std::pair<Place, Place> ends(const Edge& edge) const {
    const Vec3 &p = nodes_[edge.first], &q = nodes_[edge.second];
    const Place a{p.x(), p.y(), p.z()}, b{q.x(), q.y(), q.z()};
    return {std::min(a, b), std::max(a, b)};
  }

  bool comes_first(const Edge& a, const Edge& b) const { return ends(a) < ends(b); }

  double squared_length(const Edge& edge) const {
    return (nodes_[edge.first] - nodes_[edge.second]).squaredNorm();
  }

  /// Places in kTetrahedronEdges.
  std::size_t longest_edge(const Tetrahedron& t) const {
    std::size_t longest = 0;
    Edge best{};
    double best_length = -1;
    for (std::size_t e = 0; e < kTetrahedronEdges.size(); ++e) {
      const Edge edge = edge_at(t, e);
      const double length = squared_length(edge);
      if (length < best_length || (length == best_length && !comes_first(edge, best))) continue;
      longest = e;
      best = edge;
      best_length = length;
    }
    return longest;
  }

  static Edge edge_at(const Tetrahedron& t, std::size_t e) {
    const auto& [a, b] = kTetrahedronEdges[e];
    return edge_of(t[static_cast<std::size_t>(a)], t[static_cast<std::size_t>(b)]);
  }

  bool lost_an_edge(const Tetrahedron& t) const {
    for (std::size_t e = 0; e < kTetrahedronEdges.size(); ++e) {
      if (middles_.contains(edge_at(t, e))) return true;
    }
    return false;
  }

  bool is_too_large(const Tetrahedron& t) const {
    double longest = 0;
    Vec3 mean = Vec3::Zero();
    for (std::size_t e = 0; e < kTetrahedronEdges.size(); ++e) {
      const Edge edge = edge_at(t, e);
      const double length = squared_length(edge);
      const double allowed = size_((nodes_[edge.first] + nodes_[edge.second]) / 2);
      if (length > allowed * allowed) return true;
      longest = std::max(longest, length);
    }
    for (const auto node : t) mean += nodes_[node] / 4;
    const double allowed = size_(mean);
    return longest > allowed * allowed;
  }

  std::uint32_t middle_of(const Edge& edge) {
    const auto [at, is_new] = middles_.try_emplace(edge, static_cast<std::uint32_t>(nodes_.size()));
    if (is_new) {
      if (nodes_.size() >= most_nodes_) {
        throw InputError("refined, it would have more than " + std::to_string(most_nodes_) +
                         " nodes; allow longer edges or let them grow faster");
      }
      nodes_.push_back((nodes_[edge.first] + nodes_[edge.second]) / 2);
    }
    return at->second;
  }

  void append_leaves(Leaf leaf, std::vector<Leaf>& leaves) {
    leaf.is_small_enough = leaf.is_small_enough || !is_too_large(leaf.corners);
    if (leaf.is_small_enough && !lost_an_edge(leaf.corners)) return leaves.push_back(leaf);
    const std::size_t e = longest_edge(leaf.corners);
    const std::uint32_t middle = middle_of(edge_at(leaf.corners, e));
    for (const int end : {kTetrahedronEdges[e][1], kTetrahedronEdges[e][0]}) {
      Leaf half{leaf.corners, false};
      half.corners[static_cast<std::size_t>(end)] = middle;
      append_leaves(half, leaves);
    }
  }

  std::vector<Vec3> nodes_;
  const SizeField& size_;
  std::size_t most_nodes_;
  std::vector<Leaf> leaves_;
  std::unordered_map<Edge, std::uint32_t, PairHash> middles_;  ///< of the edges that were halved
};

}  // namespace

TetMesh bisected(const TetMesh& mesh, const SizeField& size, std::size_t most_nodes) {
  Bisection bisection(mesh, size, most_nodes);
  while (bisection.sweep()) {
  }
  return bisection.mesh(mesh.nodes.size());
}

}  // namespace palpate::geometry
