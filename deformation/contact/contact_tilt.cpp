#include "deformation/contact/contact_tilt.h"

#include <cmath>

namespace palpate::deformation {
namespace {

/// What |∇u|² has of (u_a − u_b)², a and b the corners beside `corner` [1/m²].
double share_of_edge(const ContactRow& row, const std::vector<Vec3>& positions, int corner) {
  const int i = (corner + 1) % 3, j = (corner + 2) % 3;
  if (row.weights[i] <= 0 || row.weights[j] <= 0) return 0;
  const Vec3& apex = positions[row.nodes[static_cast<std::size_t>(corner)]];
  const Vec3 a = positions[row.nodes[static_cast<std::size_t>(i)]] - apex;
  const Vec3 b = positions[row.nodes[static_cast<std::size_t>(j)]] - apex;
  const bool on_edge = row.weights[corner] <= 0;
  return on_edge ? 1 / (a - b).squaredNorm() : a.dot(b) / a.cross(b).squaredNorm();
}

}  // namespace

void append_tilt_couplings(std::span<const ContactRow> rows, const std::vector<Vec3>& positions,
                           double h, std::vector<ContactCoupling>& couplings) {
  for (const ContactRow& row : rows) {
    const double resistance = h * row.normal_impulse * (row.radius + row.gap);
    if (row.radius == 0 || !(resistance > 0)) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const double share = share_of_edge(row, positions, corner);
      if (!(share > 0) || !std::isfinite(share)) continue;
      const Vec4f arm = wide(std::sqrt(resistance * share) * row.normal);
      ContactCoupling& coupling = couplings.emplace_back();
      coupling.nodes = row.nodes;
      coupling.arms[static_cast<std::size_t>((corner + 1) % 3)] = arm;
      coupling.arms[static_cast<std::size_t>((corner + 2) % 3)] = -arm;
    }
  }
}

}  // namespace palpate::deformation
