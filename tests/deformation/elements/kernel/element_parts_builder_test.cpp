#include <map>
#include <set>

#include "deformation/elements/kernel/element_parts.h"
#include "tests/deformation/steppers/tetrahedral_solids.h"

using namespace palpate;
using namespace palpate::deformation;
using namespace palpate::deformation::testing;

namespace {

using kernel::kGroupPairs;
using kernel::kTetrahedronLanes;
using NodePair = std::pair<std::uint32_t, std::uint32_t>;

/// In the kernel's order.
constexpr std::array<std::array<std::size_t, 2>, 6> kKernelEdges{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

NodePair sorted_pair(std::uint32_t a, std::uint32_t b) {
  return a < b ? NodePair{a, b} : NodePair{b, a};
}

/// Edges of the mesh, and those of its surface.
struct Edges {
  std::set<NodePair> all, of_surface;

  explicit Edges(const OrganModel& model) {
    for (const auto& t : model.mesh().tetrahedra) {
      for (const auto& [a, b] : kKernelEdges) all.insert(sorted_pair(t[a], t[b]));
    }
    for (const auto& [a, b, c] : model.triangles) {
      for (const auto& pair : {sorted_pair(a, b), sorted_pair(b, c), sorted_pair(c, a)}) {
        of_surface.insert(pair);
      }
    }
  }
};

/// Node pairs (row, column) by their places.
std::map<std::uint32_t, NodePair> pairs_of(const ElementParts& parts) {
  std::map<std::uint32_t, NodePair> pairs;
  for (const auto& part : parts.parts()) {
    for (std::uint32_t k = 0; k < kGroupPairs * part.group_count; ++k) {
      const std::uint32_t row = parts.node(part.rows[k / kGroupPairs] / 4);
      const std::uint32_t column = parts.node(part.columns[k] / 4);
      if (column == ElementParts::kNoNode) continue;
      pairs[static_cast<std::uint32_t>(kGroupPairs * part.first_group) + k] = {row, column};
    }
  }
  return pairs;
}

}  // namespace

TEST_CASE("element parts: every edge has one place, and those of the surface are open") {
  // Oracle: sets of edges and of the surface's, counted.
  const auto model = cube_model(solid_organ("nodal_pressure", 0.49), Vec3::Zero(), GENERATE(2, 11));
  const ElementParts parts(LinearTetrahedra(model.rest_positions, model.mesh().tetrahedra));
  const Edges edges(model);
  const auto pairs = pairs_of(parts);
  std::set<NodePair> found, open;
  for (const auto& [place, pair] : pairs) found.insert(sorted_pair(pair.first, pair.second));
  CHECK(found == edges.all);
  CHECK(pairs.size() == edges.all.size());
  for (const auto& part : parts.parts()) {
    for (std::size_t k = 0; k < part.open_count; ++k) {
      const auto [row, column] = pairs.at(part.open_pairs[k].pair);
      CHECK(parts.node(part.open_pairs[k].row / 4) == row);
      CHECK(parts.node(part.open_pairs[k].column / 4) == column);
      open.insert(sorted_pair(row, column));
    }
  }
  CHECK(open == edges.of_surface);
  // Groups are nearly full: one in twenty places is empty at most, in a mesh of some size.
  std::size_t places = 0;
  for (const auto& part : parts.parts()) places += kGroupPairs * part.group_count;
  if (model.node_count() > 1000) CHECK(20 * pairs.size() > 19 * places);
}

TEST_CASE("element parts: every tetrahedron stands once, its edges where they are added up") {
  // Oracle: the mesh's own list; where another part owns an edge, what is merged.
  const auto model = cube_model(solid_organ("nodal_pressure", 0.49), Vec3::Zero(), 11);
  const ElementParts parts(LinearTetrahedra(model.rest_positions, model.mesh().tetrahedra));
  CHECK(parts.parts().size() > 1);
  auto pairs = pairs_of(parts);
  for (const auto& part : parts.parts()) {
    for (std::size_t k = 0; k < part.pair_merge_count; ++k) {
      pairs[part.pair_merges[k].from] = pairs.at(part.pair_merges[k].to);
    }
  }
  std::multiset<std::array<std::uint32_t, 4>> found, expected;
  for (const auto& t : model.mesh().tetrahedra) expected.insert(t);
  const kernel::Tetrahedra tetrahedra = parts.tetrahedra();
  for (const auto& part : parts.parts()) {
    for (std::size_t k = 0; k < part.tetrahedron_count; ++k) {
      const std::size_t batch = part.first_batch + k / kTetrahedronLanes;
      const std::size_t lane = k % kTetrahedronLanes;
      std::array<std::uint32_t, 4> corners{};
      for (std::size_t c = 0; c < 4; ++c) {
        const auto slot = tetrahedra.corners[(batch * 4 + c) * kTetrahedronLanes + lane] / 4;
        corners[c] = parts.node(slot);
      }
      found.insert(corners);
      for (std::size_t e = 0; e < 6; ++e) {
        const std::size_t at = (batch * 6 + e) * kTetrahedronLanes + lane;
        const auto& [a, b] = kKernelEdges[e];
        const NodePair ahead{corners[a], corners[b]}, back{corners[b], corners[a]};
        CHECK(pairs.at(tetrahedra.pairs[at]) == (tetrahedra.flips[at] > 0 ? back : ahead));
      }
    }
  }
  CHECK(found == expected);
}

TEST_CASE("element parts: a node's first slot owns it") {
  // Oracle: counted over all parts.
  const auto model = cube_model(solid_organ("nodal_pressure", 0.49), Vec3::Zero(), 11);
  const ElementParts parts(LinearTetrahedra(model.rest_positions, model.mesh().tetrahedra));
  std::map<std::uint32_t, std::size_t> owned, merged;
  for (const auto& part : parts.parts()) {
    for (std::size_t k = 0; k < part.owned_count; ++k) ++owned[parts.node(part.owned[k])];
    for (std::size_t k = 0; k < part.node_merge_count; ++k) {
      CHECK(parts.node(part.node_merges[k].from) == parts.node(part.node_merges[k].to));
      ++merged[parts.node(part.node_merges[k].to)];
    }
  }
  for (std::uint32_t node = 0; node < model.node_count(); ++node) {
    CHECK(owned[node] == 1);
    CHECK(merged[node] == parts.slots(node).size() - 1);
  }
}
