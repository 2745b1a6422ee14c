#include "modules/core/touch.h"

#include <algorithm>
#include <limits>

namespace palpate {

double ContactSet::deepest_gap() const {
  double deepest = std::numeric_limits<double>::infinity();
  for (const FaceContacts& face : faces) deepest = std::min(deepest, face.gap);
  for (const Contact& contact : contacts) deepest = std::min(deepest, contact.gap);
  return deepest;
}

void ContactSet::clear() {
  truncated = false;
  faces.clear();
  face_nodes.clear();
  contacts.clear();
}

Contact contact_on_face(const FaceContacts& face, const Vec3& tissue_P) {
  Contact contact;
  contact.organ = face.organ;
  contact.normal_P = face.normal_P;
  contact.gap = face.normal_P.dot(face.point_P - tissue_P);
  contact.point_P = tissue_P + contact.gap * face.normal_P;
  return contact;
}

bool LocalLaw::touching() const {
  return std::ranges::any_of(rows, [](const LawRow& row) { return row.force.dot(row.normal) > 0; });
}

Vec3 LocalLaw::force() const {
  Vec3 sum = Vec3::Zero();
  for (const LawRow& row : rows) sum += row.force;
  return sum;
}

Vec3 LocalLaw::torque() const {
  Vec3 sum = Vec3::Zero();
  for (const LawRow& row : rows) sum += (anchor.rotation * row.point_P).cross(row.force);
  return sum;
}

Mat3 contact_basis(const Vec3& normal) {
  Mat3 basis;
  basis.col(0) = normal;
  basis.col(1) = normal.unitOrthogonal();
  basis.col(2) = normal.cross(basis.col(1));
  return basis;
}

}  // namespace palpate
