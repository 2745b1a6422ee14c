#include "deformation/elements/corotational.h"

#include "modules/core/polar_decomposition.h"

namespace palpate::deformation {

Corotational::Corotational(LinearTetrahedra tetrahedra, const ElasticConstants& tissue)
    : tetrahedra_(std::move(tetrahedra)),
      law_(tissue),
      pairs_(tetrahedra_.node_count, tetrahedra_.corners),
      matrix_(pairs_),
      forces_(tetrahedra_.node_count),
      diagonal_(tetrahedra_.node_count) {}

void Corotational::linearise(const std::vector<Vec3>& positions, double scale,
                             std::span<const double> shift) {
  std::fill(forces_.begin(), forces_.end(), Vec3::Zero());
  matrix_.set_zero();
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    add_tetrahedron(e, positions, static_cast<float>(scale));
  }
  for (std::size_t i = 0; i < shift.size(); ++i) {
    matrix_.add(pairs_.diagonals[i], static_cast<float>(shift[i]));
  }
  matrix_.mirror();
  for (std::size_t i = 0; i < shift.size(); ++i) diagonal_[i] = matrix_.diagonal(i);
}

void Corotational::add_tetrahedron(std::size_t e, const std::vector<Vec3>& positions, float scale) {
  const auto& corners = tetrahedra_.corners[e];
  const Mat3 F = tetrahedra_.deformation_gradient(e, positions);
  const Mat3 R = nearest_rotation(F);
  const double volume = tetrahedra_.volumes[e];
  const Mat34 pushes = -volume * (law_.first_piola_stress(F, R) * tetrahedra_.gradients[e]);
  const Mat34 turned = R * tetrahedra_.gradients[e];
  std::array<Vec4f, 4> g;
  for (int a = 0; a < 4; ++a) {
    forces_[corners[static_cast<std::size_t>(a)]] += pushes.col(a);
    g[static_cast<std::size_t>(a)] = wide(turned.col(a));
  }
  const float mu = scale * static_cast<float>(volume * law_.shear_modulus);
  const float lambda = scale * static_cast<float>(volume * law_.lambda);
  for (std::size_t a = 0; a < 4; ++a) {
    const Vec4f along = lambda * g[a], across = mu * g[a];
    for (std::size_t b = 0; b < 4; ++b) {
      if (corners[b] < corners[a]) continue;
      Block4f block;
      const float both = across.dot(g[b]);
      for (int k = 0; k < 3; ++k) {
        auto& column = block[static_cast<std::size_t>(k)];
        column = g[b][k] * along + across[k] * g[b];
        column[k] += both;
      }
      matrix_.add(pairs_.of_elements[e][4 * a + b], block);
    }
  }
}

double Corotational::energy(const std::vector<Vec3>& positions) {
  double sum = 0;
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    sum += tetrahedra_.volumes[e] *
           law_.energy_density(tetrahedra_.deformation_gradient(e, positions));
  }
  return sum;
}

}  // namespace palpate::deformation
