#include "deformation/spring_network.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "modules/geometry/primitives.h"

namespace palpate::deformation {
namespace {

scene::Tissue tissue() {
  scene::Tissue tissue;
  tissue.youngs_modulus = 10e3;
  tissue.wall_thickness = 3e-3;
  return tissue;
}

scene::Springs springs(double bending, double inner, std::size_t virtual_nodes) {
  return {bending, inner, virtual_nodes};
}

/// Elastic energy of the network when every node moves radially by strain·r.
double radial_energy(const SpringNetwork& network, double strain, std::size_t first,
                     std::size_t count) {
  double energy = 0;
  for (std::size_t s = first; s < first + count; ++s) {
    const Spring& spring = network.springs[s];
    const auto moved = [&](std::uint32_t i) -> Vec3 {
      const double scale = i < network.surface_node_count ? 1 + strain : 1;
      return scale * network.rest_positions[i];
    };
    const double stretch =
        (moved(spring.node_b) - moved(spring.node_a)).norm() - spring.rest_length;
    energy += 0.5 * spring.stiffness * stretch * stretch;
  }
  return energy;
}

TEST_CASE("spring network: an edge of a regular tetrahedron has twice (√3/4) E t") {
  // Oracle: analytic, two equilateral triangles per edge.
  const auto network =
      build_spring_network(geometry::make_tetrahedron(0.1), tissue(), springs(0, 0, 0));
  REQUIRE(network.structural_count == 6);
  REQUIRE(network.springs.size() == 6);
  for (const Spring& spring : network.springs) {
    CHECK(spring.stiffness == Approx(2 * std::sqrt(3.0) / 4 * 10e3 * 3e-3).epsilon(1e-12));
    CHECK(spring.rest_length == Approx(0.1).epsilon(1e-12));
  }
}

TEST_CASE("spring network: an inflated sphere stores the membrane's energy for any bending ratio") {
  // Oracle: analytic. Equibiaxial strain ε in a membrane with ν = 1/3 stores E t ε²/(1−ν) per
  // area. 3 %: an icosphere's triangles are not equilateral (areas vary by ±15 %).
  const double ratio = GENERATE(0.0, 0.1, 0.3, 1.0);
  const auto ball = geometry::make_ball(0.05, 3);
  const auto network = build_spring_network(ball, tissue(), springs(ratio, 0, 0));
  const double strain = 1e-3;
  const double area = geometry::surface_area(ball.nodes, ball.triangles);
  const double expected = 10e3 * 3e-3 * strain * strain / (1 - 1.0 / 3) * area;
  CHECK(radial_energy(network, strain, 0, network.springs.size()) ==
        Approx(expected).epsilon(0.03));
}

TEST_CASE("spring network: bending springs join exactly the nodes two edges apart") {
  // Oracle: brute force over all pairs.
  const auto ball = geometry::make_ball(0.05, 2);
  const auto network = build_spring_network(ball, tissue(), springs(0.1, 0, 0));
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges, found;
  for (const auto& [a, b] : geometry::edges_of(ball.triangles)) edges.insert({a, b});
  for (std::size_t s = network.structural_count; s < network.springs.size(); ++s) {
    CHECK(network.family(s) == SpringFamily::kBending);
    const auto [a, b] = std::minmax(network.springs[s].node_a, network.springs[s].node_b);
    CHECK(found.insert({a, b}).second);
  }
  const auto joined = [&](std::uint32_t a, std::uint32_t b) {
    return edges.count({std::min(a, b), std::max(a, b)}) > 0;
  };
  const auto node_count = static_cast<std::uint32_t>(ball.nodes.size());
  for (std::uint32_t a = 0; a < node_count; ++a) {
    for (std::uint32_t b = a + 1; b < node_count; ++b) {
      bool two_apart = false;
      for (std::uint32_t m = 0; m < node_count; ++m) two_apart |= joined(a, m) && joined(m, b);
      REQUIRE(found.count({a, b}) == (two_apart && !joined(a, b) ? 1u : 0u));
    }
  }
}

TEST_CASE("spring network: inner springs go to the nearest virtual node and fill the mesh evenly") {
  // Oracle: brute force for the nearest; mesh independence of the energy per strain (2 %: the
  // virtual nodes move a little with the mesh).
  double energies[2];
  for (int levels = 2; levels <= 3; ++levels) {
    const auto ball = geometry::make_ball(0.05, levels);
    const auto network = build_spring_network(ball, tissue(), springs(0.1, 0.5, 4));
    REQUIRE(network.inner_count == ball.nodes.size());
    const std::size_t first = network.structural_count + network.bending_count;
    for (std::size_t s = first; s < network.springs.size(); ++s) {
      const Spring& spring = network.springs[s];
      CHECK(network.family(s) == SpringFamily::kInner);
      REQUIRE(spring.node_b >= network.surface_node_count);
      for (std::size_t v = network.surface_node_count; v < network.rest_positions.size(); ++v) {
        CHECK(spring.rest_length <=
              (network.rest_positions[v] - network.rest_positions[spring.node_a]).norm() + 1e-15);
      }
    }
    energies[levels - 2] = radial_energy(network, 1e-3, first, network.inner_count);
  }
  CHECK(energies[0] == Approx(energies[1]).epsilon(0.05));
}

TEST_CASE("spring network: virtual nodes lie on the dominant axis of a long box") {
  // Oracle: symmetry of the box; sections are of equal length.
  const auto box = geometry::make_box(Vec3(0.04, 0.3, 0.04), 12);
  const auto nodes = place_virtual_nodes(box, 3);
  REQUIRE(nodes.size() == 3);
  for (const Vec3& p : nodes) {
    CHECK(std::abs(p.x()) < 1e-9);
    CHECK(std::abs(p.z()) < 1e-9);
  }
  CHECK(nodes[0].y() < -0.05);
  CHECK(std::abs(nodes[1].y()) < 0.02);
  CHECK(nodes[2].y() > 0.05);
}

}  // namespace
}  // namespace palpate::deformation
