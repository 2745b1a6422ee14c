// The volume along a straight line in configuration space, V(x + s d), is a cubic in s.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "modules/geometry/triangle_surface.h"

namespace palpate::deformation {

/// Coefficients c₀ … c₃ of V(x + s d) = c₀ + c₁ s + c₂ s² + c₃ s³: with the triple product
/// [a b c] = a·(b×c) of a triangle's corners, 6 V = Σ [x₁+s d₁, x₂+s d₂, x₃+s d₃]. So c₁ = g·d and
/// 2 c₂ = dᵀ(∂g/∂x) d.
/// @param directions  at least one per surface node
std::array<double, 4> volume_along_line(const std::vector<geometry::Triangle>& triangles,
                                        const std::vector<Vec3>& positions,
                                        const std::vector<Vec3>& directions);

/// The real root of c₀ + c₁ s + c₂ s² + c₃ s³ of least magnitude, in closed form and polished by
/// Newton; none if there is none (c₁ = c₂ = c₃ = 0) or c₁ = 0, where the line does not change the
/// volume to first order.
std::optional<double> nearest_root(const std::array<double, 4>& cubic);

}  // namespace palpate::deformation
