#include "studies/chart/case_parts.h"

#include <cmath>

namespace palpate::chart {

Measurement summary(const rigs::PressedOrgan& pressed, const geometry::OrganShape& shape) {
  Measurement result;
  result.surface_nodes = shape.surface.nodes.size();
  result.inner_nodes = shape.inner_nodes.size();
  result.tetrahedra = shape.tetrahedra.size();
  result.step = pressed.step();
  result.cost = pressed.time() > 0 ? pressed.busy() / pressed.time() : 0;
  result.volume_error = pressed.volume_error();
  result.diverged = pressed.diverged() || pressed.lacks_contacts();
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

double contact_radius(const rigs::PressedOrgan& pressed, const Vec3& normal,
                      const std::function<double(const Vec3&)>& outside) {
  double area = 0;
  for (const auto& triangle : pressed.model().triangles) {
    const Vec3 a = pressed.position(triangle[0]), b = pressed.position(triangle[1]),
               c = pressed.position(triangle[2]);
    int touching = 0;
    for (const Vec3& corner : {a, b, c}) touching += outside(corner) < kTouchDistance;
    area += touching / 3.0 * std::abs(normal.dot((b - a).cross(c - a))) / 2;
  }
  return std::sqrt(area / M_PI);
}

}  // namespace palpate::chart
