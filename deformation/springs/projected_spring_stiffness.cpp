#include "deformation/springs/projected_spring_stiffness.h"

#include <cmath>

namespace palpate::deformation {
namespace {

constexpr float kTinyProjectedSquare = 1e-20f;  // [m²]

}  // namespace

ProjectedSpringStiffness::ProjectedSpringStiffness(const Body& body, const SpringNetwork& network)
    : body_(body),
      positions_(body.node_count()),
      masses_(body.node_count()),
      diagonal_(body.node_count()) {
  for (std::size_t s = 0; s < network.springs.size(); ++s) {
    const Spring& spring = network.springs[s];
    constants_.push_back({static_cast<float>(spring.rest_length),
                          static_cast<float>(spring.stiffness),
                          static_cast<float>(network.damping[s])});
    couplings_.push_back({spring.node_a, spring.node_b, 0, 0});
  }
}

void ProjectedSpringStiffness::linearise(const std::vector<Vec3>& positions, double h) {
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    positions_[i] = wide(positions[i] - positions[0]);
    masses_[i] = static_cast<float>((1 + h * body_.drag) * body_.masses[i]);
  }
  const auto step = static_cast<float>(h);
  sums_.assign(body_.node_count(), {});
  for (std::size_t s = 0; s < couplings_.size(); ++s) {
    Coupling& coupling = couplings_[s];
    const Constants& spring = constants_[s];
    const Vec4f d = positions_[coupling.b] - positions_[coupling.a];
    const float square = d.squaredNorm();
    coupling.along = coupling.across = 0;
    if (square < kTinyProjectedSquare) continue;  // no direction, no force
    const float inverse_square = 1 / square;
    const float stretch = 1 - spring.rest_length * std::sqrt(inverse_square);
    const float h_k = step * spring.stiffness;
    // (s)₊ = (s + |s|)/2 without a branch: near rest nothing predicts the sign.
    coupling.across = 0.5f * step * h_k * (stretch + std::abs(stretch));
    coupling.along = (step * (spring.damping + h_k) - coupling.across) * inverse_square;
    const Vec4f scaled = coupling.along * d;
    const std::array<Vec4f, 3> block{scaled.x() * d, scaled.y() * d, scaled.z() * d};
    for (const std::uint32_t node : {coupling.a, coupling.b}) {
      NodeSum& sum = sums_[node];
      for (std::size_t axis = 0; axis < 3; ++axis) sum.along[axis] += block[axis];
      sum.across += coupling.across;
    }
  }
  for (std::size_t i = 0; i < diagonal_.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      diagonal_[i].col(axis) =
          sums_[i].along[static_cast<std::size_t>(axis)].head<3>().cast<double>();
    }
    diagonal_[i].diagonal().array() += static_cast<double>(masses_[i] + sums_[i].across);
  }
}

void ProjectedSpringStiffness::apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) const {
  for (std::size_t i = 0; i < p.size(); ++i) out[i] = masses_[i] * p[i];
  for (const Coupling& coupling : couplings_) {
    const Vec4f d = positions_[coupling.b] - positions_[coupling.a];
    const Vec4f difference = p[coupling.b] - p[coupling.a];
    const Vec4f change = (coupling.along * d.dot(difference)) * d + coupling.across * difference;
    out[coupling.a] -= change;
    out[coupling.b] += change;
  }
}

}  // namespace palpate::deformation
