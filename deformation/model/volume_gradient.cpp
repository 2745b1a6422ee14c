#include "deformation/model/volume_gradient.h"

namespace palpate::deformation {

void evaluate_volume(const Body& body, const std::vector<Vec3>& positions, VolumeGradient& out) {
  const Vec3& origin = positions[0];
  double six_volumes = 0;
  out.gradient.assign(body.surface_node_count, Vec3::Zero());
  for (const auto& [i, j, k] : body.triangles) {
    // Twice the area vector goes to each corner: around a node of a closed surface, these sum to
    // the same as the products of its neighbours' positions.
    const Vec3 &a = positions[i], normal = (positions[j] - a).cross(positions[k] - a);
    six_volumes += (a - origin).dot(normal);
    out.gradient[i] += normal;
    out.gradient[j] += normal;
    out.gradient[k] += normal;
  }
  out.volume = six_volumes / 6;
  out.denominator = 0;
  for (std::size_t i = 0; i < out.gradient.size(); ++i) {
    out.gradient[i] *= 1.0 / 6;
    out.denominator += out.gradient[i].squaredNorm() * body.inverse_masses[i];
  }
}

}  // namespace palpate::deformation
