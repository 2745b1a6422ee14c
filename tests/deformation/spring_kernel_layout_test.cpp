#include "deformation/spring_kernel_layout.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "organs.h"

namespace palpate::deformation {
namespace {

TEST_CASE("one-rings: each follows the triangles around its node") {
  // Oracle: brute force. Every triangle (i, j, k) makes k the successor of j in the ring of i.
  const auto ball = geometry::make_ball(0.05, 2);
  const auto rings = ordered_one_rings(ball.triangles, ball.nodes.size());
  std::size_t steps = 0;
  for (const auto& ring : rings) steps += ring.size();
  CHECK(steps == 3 * ball.triangles.size());
  for (const auto& triangle : ball.triangles) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto& ring = rings[triangle[corner]];
      const auto from = std::find(ring.begin(), ring.end(), triangle[(corner + 1) % 3]);
      REQUIRE(from != ring.end());
      const auto to = std::next(from) == ring.end() ? ring.begin() : std::next(from);
      CHECK(*to == triangle[(corner + 2) % 3]);
    }
  }
}

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
  const SpringKernelLayout layout(model);
  const auto found = half_springs(layout.view());
  const auto& network = model.network;
  const std::size_t surface_springs = network.structural_count + network.bending_count;
  CHECK(found.size() == 2 * surface_springs);
  for (std::size_t s = 0; s < surface_springs; ++s) {
    const Spring& spring = network.springs[s];
    const auto rest_length = static_cast<float>(spring.rest_length);
    REQUIRE(found.at({spring.node_a, spring.node_b}) == rest_length);
    REQUIRE(found.at({spring.node_b, spring.node_a}) == rest_length);
  }
}

TEST_CASE("spring kernel layout: rings hold the node, its one-ring, and the first again") {
  // Oracle: ordered_one_rings(). Short rings repeat their first neighbour and so close.
  const auto model = testing::ball_model(2);  // twelve nodes with five neighbours, others six
  const SpringKernelLayout layout(model);
  const auto view = layout.view();
  const auto rings = ordered_one_rings(model.triangles, view.surface_node_count);
  std::size_t repeated = 0;
  for (std::size_t row = 0; row < view.surface_node_count; ++row) {
    const kernel::RingSlice& slice = view.ring_slices[row / kernel::kRingLanes];
    const auto entry = [&](std::size_t k) {
      return view.ring_nodes[(slice.first_slot + k) * kernel::kRingLanes +
                             row % kernel::kRingLanes] /
             3;
    };
    CHECK(entry(0) == row);
    for (std::size_t k = 0; k + 1 < slice.slots; ++k) {
      CHECK(entry(k + 1) == (k < rings[row].size() ? rings[row][k] : rings[row][0]));
      if (k >= rings[row].size()) ++repeated;
    }
  }
  CHECK(repeated > 0);
}

TEST_CASE("spring kernel layout: links name each row's virtual node once") {
  // Oracle: the network's inner springs.
  const auto model = testing::ball_model(2);
  const SpringKernelLayout layout(model);
  const auto view = layout.view();
  const auto& network = model.network;
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
