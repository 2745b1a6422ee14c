#include "modules/core/touch.h"

#include <algorithm>
#include <limits>

#include "modules/core/tolerances.h"

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

/// Rodrigues' formula for what is perpendicular to n: R t = t − (t·m) / (1 + n·m) (n + m).
Mat3 turned_basis(const Mat3& basis, const Vec3& normal) {
  constexpr double kNearlyOpposite = -0.9;  // the formula divides by nothing there
  const double cosine = basis.col(0).dot(normal);
  if (cosine < kNearlyOpposite) {  // a quarter of a turn, and the rest
    const Vec3 aside = normal - cosine * basis.col(0);
    const double length = aside.norm();
    const Vec3 between = length > kDirectionless ? aside / length : basis.col(0).unitOrthogonal();
    return turned_basis(turned_basis(basis, between), normal);
  }
  const Vec3 across = (basis.col(0) + normal) / (1 + cosine);
  Mat3 turned;
  turned.col(0) = normal;
  for (int k = 1; k < 3; ++k) {
    turned.col(k) = basis.col(k) - basis.col(k).dot(normal) * across;
  }
  return turned;
}

}  // namespace palpate
