#include "deformation/contact/coupled_inverse_mass.h"

namespace palpate::deformation {

// (W⁻¹ + s a aᵀ)⁻¹ = W − s/(1 + s a·W a) (W a)(W a)ᵀ, the formula of Sherman and Morrison.
void take_coupling(const ContactCoupling& coupling, std::span<Mat3> inverse_mass_blocks) {
  double whole = 0;
  for (const Vec4f& arm : coupling.arms) whole += static_cast<double>(arm.norm());
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 arm = coupling.arms[k].head<3>().cast<double>();
    Mat3& block = inverse_mass_blocks[coupling.nodes[k]];
    if (arm.isZero(0) || block.isZero(0)) continue;
    const double factor = whole / arm.norm();
    const Vec3 answer = block * arm;
    block -= factor / (1 + factor * arm.dot(answer)) * answer * answer.transpose();
  }
}

}  // namespace palpate::deformation
