#include "deformation/volume_constraint.h"

#include "deformation/organ_model.h"

namespace palpate::deformation {

void evaluate_volume(const OrganModel& model, const std::vector<Vec3>& positions,
                     VolumeGradient& out) {
  const Vec3& origin = positions[0];
  double six_volumes = 0;
  out.gradient.assign(model.surface_node_count(), Vec3::Zero());
  for (const auto& [i, j, k] : model.triangles) {
    const Vec3 a = positions[i] - origin, b = positions[j] - origin, c = positions[k] - origin;
    const Vec3 b_cross_c = b.cross(c);
    six_volumes += a.dot(b_cross_c);
    out.gradient[i] += b_cross_c;
    out.gradient[j] += c.cross(a);
    out.gradient[k] += a.cross(b);
  }
  out.volume = six_volumes / 6;
  out.denominator = 0;
  for (std::size_t i = 0; i < out.gradient.size(); ++i) {
    out.gradient[i] /= 6;
    out.denominator += out.gradient[i].squaredNorm() * model.inverse_masses[i];
  }
}

}  // namespace palpate::deformation
