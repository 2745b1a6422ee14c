#include "deformation/model/spring_network.h"

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

constexpr double kMembrane = kMembraneFactor * 10e3 * 3e-3;  // E t of the springs [N/m]

scene::Springs springs(double bending, double inner, std::size_t virtual_nodes) {
  return {bending, inner, virtual_nodes};
}

/// Elastic energy of the network when every node moves radially by strain·r.
double radial_energy(const SpringNetwork& network, const std::vector<Vec3>& surface, double strain,
                     std::size_t first, std::size_t count) {
  double energy = 0;
  for (std::size_t s = first; s < first + count; ++s) {
    const Spring& spring = network.springs[s];
    const auto moved = [&](std::uint32_t i) -> Vec3 {
      return i < surface.size() ? Vec3((1 + strain) * surface[i])
                                : network.virtual_nodes[i - surface.size()];
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
    CHECK(spring.stiffness == Approx(2 * std::sqrt(3.0) / 4 * kMembrane).epsilon(1e-12));
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
  const double expected = kMembrane * strain * strain / (1 - 1.0 / 3) * area;
  CHECK(radial_energy(network, ball.nodes, strain, 0, network.springs.size()) ==
        Approx(expected).epsilon(0.03));
}

/// A flat regular lattice of edge length `edge`, 2 n + 1 by 2 n + 1 nodes, rolled without stretch
/// onto a cylinder of this curvature about the y-axis.
std::vector<Vec3> rolled_lattice(int n, double edge, double curvature) {
  std::vector<Vec3> nodes;
  for (int row = -n; row <= n; ++row) {
    for (int column = -n; column <= n; ++column) {
      const double along = edge * (column + 0.5 * row), across = edge * std::sqrt(0.75) * row;
      nodes.emplace_back(std::sin(curvature * along) / curvature, across,
                         std::cos(curvature * along) / curvature);
    }
  }
  return nodes;
}

TEST_CASE("spring network: bending springs give a wall next to no bending stiffness") {
  // Oracle: analytic. A chord of surface length s at angle φ to the bent direction changes its
  // length by κ δκ s³ cos⁴φ/12, so D = E t κ² L⁴/144 · (S₁ + r S₂)/(1 + 7 r) with Σ (s/L)⁶ cos⁸φ of
  // the three springs: S₁ = 1.0078 of edges, S₂ = 64·1.0078 + 27·0.6328 of bending springs. 2 %:
  // higher orders. A wall's D is E t³/9: the springs' is below a tenth of it and falls with L⁴.
  const int n = 6;
  const double edge = 4e-3, curvature = 20, change = 0.01, ratio = GENERATE(0.0, 0.1, 1.0);
  const auto width = static_cast<std::uint32_t>(2 * n + 1);
  geometry::TriangleSurface sheet;
  sheet.nodes = rolled_lattice(n, edge, curvature);
  for (std::uint32_t row = 0; row + 1 < width; ++row) {
    for (std::uint32_t column = 0; column + 1 < width; ++column) {
      const std::uint32_t i = row * width + column;
      sheet.triangles.push_back({i, i + 1, i + width});
      sheet.triangles.push_back({i + 1, i + width + 1, i + width});
    }
  }
  const auto network = build_spring_network(sheet, tissue(), springs(ratio, 0, 0));
  const auto bent = rolled_lattice(n, edge, curvature + change);
  const std::uint32_t middle = static_cast<std::uint32_t>(n) * width + n;
  double energy = 0;  // of one node: half of each of its springs
  for (const Spring& spring : network.springs) {
    if (spring.node_a != middle && spring.node_b != middle) continue;
    const double stretch = (bent[spring.node_a] - bent[spring.node_b]).norm() - spring.rest_length;
    energy += 0.25 * spring.stiffness * stretch * stretch;
  }
  const double node_area = std::sqrt(0.75) * edge * edge;
  const double stiffness = 2 * energy / (node_area * change * change);
  const double sums = (1.0078 + ratio * (64 * 1.0078 + 27 * 0.6328)) / (1 + 7 * ratio);
  CHECK(stiffness ==
        Approx(kMembrane * std::pow(curvature * edge * edge, 2) / 144 * sums).epsilon(0.02));
  CHECK(stiffness < 0.1 * 10e3 * std::pow(3e-3, 3) / 9);
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
      REQUIRE(spring.node_b >= ball.nodes.size());
      for (const Vec3& inside : network.virtual_nodes) {
        CHECK(spring.rest_length <= (inside - ball.nodes[spring.node_a]).norm() + 1e-15);
      }
    }
    energies[levels - 2] = radial_energy(network, ball.nodes, 1e-3, first, network.inner_count);
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

TEST_CASE("spring network: one tetrahedron gets one virtual node, and no spring without length") {
  // Oracle: its centroid; every section along its axis would hold one or two nodes.
  const auto tetrahedron = geometry::make_tetrahedron(0.1);
  const auto nodes = place_virtual_nodes(tetrahedron, 9);
  REQUIRE(nodes.size() == 1);
  CHECK(nodes[0].norm() < 1e-12);
  const auto network = build_spring_network(tetrahedron, {}, {});
  for (const Spring& spring : network.springs) CHECK(spring.rest_length > 0.01);
}

}  // namespace
}  // namespace palpate::deformation
