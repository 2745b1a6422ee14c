// Normals, displacement and strain, derived from node positions for the picture.
//
// Strain of a triangle: with the edge matrices D₀ (rest) and D (now) in the triangle's plane,
// C = (D D₀⁻¹)ᵀ(D D₀⁻¹) has the eigenvalues λ₁², λ₂² of the principal stretches; shown is the
// principal strain of larger magnitude, max(|λ₁ − 1|, |λ₂ − 1|). A uniform scaling by s gives
// |s − 1| everywhere, a rigid motion 0.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate::visualizer {

using TriangleIndices = std::array<std::uint32_t, 3>;

/// Unit node normals, area-weighted  (node_count × 3); zero for nodes of no triangle.
/// @param positions  x, y, z per node [m]  (node_count × 3)
void node_normals(std::span<const float> positions, std::span<const TriangleIndices> triangles,
                  std::vector<float>& normals);

/// |x − x₀| of each node [m]. Both spans have the same size, node_count × 3.
void node_displacements(std::span<const float> rest, std::span<const float> positions,
                        std::vector<float>& displacements);

/// Magnitude of the larger principal strain of each triangle (1 = 100 %); 0 for triangles without
/// area at rest.
void triangle_strains(std::span<const float> rest, std::span<const float> positions,
                      std::span<const TriangleIndices> triangles, std::vector<float>& strains);

/// Mean of the adjacent triangles' values, weighted by rest area; 0 for nodes of no triangle.
void average_to_nodes(std::span<const float> rest, std::span<const TriangleIndices> triangles,
                      std::span<const float> triangle_values, std::vector<float>& node_values);

}  // namespace palpate::visualizer
