#include "deformation/springs/kernel/spring_kernel_layout.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

/// Springs between surface nodes as the layout holds them: (node, neighbour) → rest length.
std::map<std::pair<std::uint32_t, std::uint32_t>, float> half_springs(
    const kernel::Layout& layout) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, float> found;
  for (std::size_t s = 0; s < layout.slice_count; ++s) {
    const kernel::Slice& slice = layout.slices[s];
    for (std::size_t lane = 0; lane < kernel::kLanes; ++lane) {
      const std::size_t row = s * kernel::kLanes + lane;
      for (std::size_t k = 0; k < slice.slots; ++k) {
        const std::size_t at = (slice.first_slot + k) * kernel::kLanes + lane;
        const std::uint32_t node = layout.row_nodes[row] / kernel::kNodeFloats;
        const std::uint32_t other = layout.neighbours[at] / kernel::kNodeFloats;
        if (other == node) {  // padding
          CHECK(layout.rest_lengths[at] == kernel::kPaddingLength);
          continue;
        }
        CHECK(row < layout.surface_node_count);
        CHECK(found.insert({{node, other}, layout.rest_lengths[at]}).second);
      }
    }
  }
  return found;
}

TEST_CASE("spring kernel layout: holds every spring of the network once from each end") {
  // Oracle: the network. 42 and 162 nodes: neither a multiple of the slice.
  const auto model = testing::ball_model(GENERATE(1, 2));
  const SpringKernelLayout layout(model, model.network(), true);
  const auto found = half_springs(layout.view());
  const auto& network = model.network();
  const std::size_t surface_springs = network.structural_count + network.bending_count;
  CHECK(found.size() == 2 * surface_springs);
  for (std::size_t s = 0; s < surface_springs; ++s) {
    const Spring& spring = network.springs[s];
    const auto rest_length = static_cast<float>(spring.rest_length);
    REQUIRE(found.at({spring.node_a, spring.node_b}) == rest_length);
    REQUIRE(found.at({spring.node_b, spring.node_a}) == rest_length);
  }
}

TEST_CASE("spring kernel layout: structural neighbours stand in the order of the one-ring") {
  // Oracle: ordered_one_rings().
  const auto model = testing::ball_model(2);  // twelve nodes with five neighbours, others six
  const SpringKernelLayout layout(model, model.network(), true);
  const auto view = layout.view();
  const auto rings = geometry::ordered_one_rings(model.triangles, view.surface_node_count);
  std::size_t shorter = 0;
  for (std::size_t row = 0; row < view.surface_node_count; ++row) {
    const kernel::Slice& slice = view.slices[row / kernel::kLanes];
    CHECK(slice.shortest_ring <= rings[row].size());
    REQUIRE(rings[row].size() <= slice.structural_slots);
    if (rings[row].size() < slice.structural_slots) ++shorter;
    for (std::size_t k = 0; k < rings[row].size(); ++k) {
      const std::size_t at = (slice.first_slot + k) * kernel::kLanes + row % kernel::kLanes;
      CHECK(view.neighbours[at] == kernel::kNodeFloats * rings[row][k]);
    }
  }
  CHECK(shorter > 0);
}

geometry::Triangle lowest_first(geometry::Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

geometry::TriangleSurface some_surface() {
  return GENERATE(geometry::make_ball(0.05, 2), geometry::make_tetrahedron(0.1),
                  geometry::make_box(Vec3(0.1, 0.06, 0.08), 3),
                  geometry::make_capsule(0.03, 0.1, 30));
}

/// Of fans side by side those in a lane, as the layout holds them; padding has no area: a node
/// twice.
std::vector<geometry::Triangle> triangles_in(const kernel::FanTable& table, std::size_t index,
                                             std::size_t lane) {
  const kernel::Fans& fans = table.fans[index];
  CHECK(fans.slots % 2 == 0);
  const auto node = [&](std::size_t slot) {
    return table.nodes[(fans.first_slot + slot) * kernel::kDoubleLanes + lane] / 3;
  };
  std::vector<geometry::Triangle> triangles;
  for (std::size_t slot = 1; slot + 1 < fans.slots; ++slot) {
    if (node(slot) != node(slot + 1)) triangles.push_back({node(0), node(slot), node(slot + 1)});
  }
  return triangles;
}

OrganModel some_model() {
  auto organ = testing::ball_organ();
  organ.springs = {0.1, 0.5, 1};
  return build_organ_model(organ, Vec3::Zero(), some_surface());
}

TEST_CASE("spring kernel layout: the cover holds each triangle once, and none besides") {
  // Oracle: the triangles.
  const auto model = some_model();
  const SpringKernelLayout layout(model, model.network(), true);
  const auto view = layout.view();
  std::multiset<geometry::Triangle> expected, found;
  for (const auto& triangle : model.triangles) expected.insert(lowest_first(triangle));
  REQUIRE(view.first_fans[0] == 0);
  for (std::uint32_t fans = 0; fans < view.first_fans[view.chunk_count]; ++fans) {
    for (std::size_t lane = 0; lane < kernel::kDoubleLanes; ++lane) {
      for (const auto& t : triangles_in(view.cover, fans, lane)) found.insert(lowest_first(t));
    }
  }
  CHECK(found == expected);
}

TEST_CASE("spring kernel layout: the ring of a row holds the triangles around its node") {
  // Oracle: the triangles.
  const auto model = some_model();
  const SpringKernelLayout layout(model, model.network(), true);
  const auto view = layout.view();
  for (std::uint32_t row = 0; row < view.surface_node_count; ++row) {
    std::set<geometry::Triangle> expected, found;
    for (const auto& triangle : model.triangles) {
      if (std::count(triangle.begin(), triangle.end(), row) > 0) {
        expected.insert(lowest_first(triangle));
      }
    }
    for (const auto& t :
         triangles_in(view.rings, row / kernel::kDoubleLanes, row % kernel::kDoubleLanes)) {
      CHECK(t[0] == row);
      CHECK(found.insert(lowest_first(t)).second);
    }
    CHECK(found == expected);
  }
}

TEST_CASE("spring kernel layout: links name each row's virtual node once") {
  // Oracle: the network's inner springs.
  const auto model = testing::ball_model(2);
  const SpringKernelLayout layout(model, model.network(), true);
  const auto view = layout.view();
  const auto& network = model.network();
  for (std::size_t i = 0; i < network.inner_count; ++i) {
    const Spring& spring = network.springs[network.springs.size() - network.inner_count + i];
    const kernel::Slice& slice = view.slices[spring.node_a / kernel::kLanes];
    float weight = 0;
    for (std::uint32_t k = 0; k < slice.link_count; ++k) {
      const kernel::Link& link = view.links[slice.first_link + k];
      const float here = link.weights[spring.node_a % kernel::kLanes];
      if (link.virtual_node + view.surface_node_count == spring.node_b) weight = here;
      if (link.virtual_node + view.surface_node_count != spring.node_b) CHECK(here == 0);
    }
    CHECK(weight == 1);
  }
}

}  // namespace
}  // namespace palpate::deformation
