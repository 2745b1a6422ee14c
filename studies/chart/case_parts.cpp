#include "studies/chart/case_parts.h"

#include <cmath>

namespace palpate::chart {

void move_and_settle(Stage& stage, std::vector<Pose>& poses, const std::vector<Vec3>& to,
                     double speed, const KeepGoing& keep_going) {
  double longest = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    longest = std::max(longest, (to[i] - poses[i].position).norm());
  }
  const int steps = std::max(1, static_cast<int>(std::ceil(longest / (speed * stage.period()))));
  const std::vector<Pose> from = poses;
  for (int k = 1; k <= steps; ++k) {
    keep_going();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i].position = from[i].position + double(k) / steps * (to[i] - from[i].position);
    }
    stage.advance(poses);
  }
  keep_going();
  stage.settle(kLongestSettling);
}

Measurement summary(const Stage& stage, const geometry::OrganShape& shape) {
  Measurement result;
  result.surface_nodes = shape.surface.nodes.size();
  result.inner_nodes = shape.inner_nodes.size();
  result.tetrahedra = shape.tetrahedra.size();
  result.step = stage.step();
  result.cost = stage.time() > 0 ? stage.busy() / stage.time() : 0;
  result.volume_error = stage.volume_error();
  result.diverged = stage.diverged();
  return result;
}

Measurement summary(const deformation::TaylorHoodElements& solid) {
  const auto& mesh = solid.mesh();
  std::vector<char> on_surface(mesh.nodes.size(), 0);
  for (const auto& face : mesh.faces) {
    for (int k = 0; k < deformation::kFaceNodes; ++k) on_surface[mesh.face_node(face, k)] = 1;
  }
  Measurement result;
  for (const char on : on_surface) (on ? result.surface_nodes : result.inner_nodes) += 1;
  result.tetrahedra = mesh.elements.size();
  return result;
}

double contact_radius(const Stage& stage, const Vec3& normal,
                      const std::function<double(const Vec3&)>& outside) {
  double area = 0;
  for (const auto& triangle : stage.model().triangles) {
    const Vec3 a = stage.position(triangle[0]), b = stage.position(triangle[1]),
               c = stage.position(triangle[2]);
    int touching = 0;
    for (const Vec3& corner : {a, b, c}) touching += outside(corner) < kTouchDistance;
    area += touching / 3.0 * std::abs(normal.dot((b - a).cross(c - a))) / 2;
  }
  return std::sqrt(area / M_PI);
}

}  // namespace palpate::chart
