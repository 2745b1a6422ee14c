// What touches tissue on fixed nodes.
#include <algorithm>

#include "deformation/contact/gauss_seidel.h"
#include "deformation/contact/probe_contacts.h"

namespace palpate::deformation {

bool is_on_fixed_nodes(const CarriedContact& contact, const Body& body) {
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t node = body.triangles[contact.triangle][static_cast<std::size_t>(k)];
    if (contact.barycentric[k] != 0 && body.inverse_masses[node] != 0) return false;
  }
  return true;
}

CarriedContact::OnFixed press_fixed(const CarriedContact& contact, const Body& body, double h,
                                    ContactRow row) {
  const double stiffness = 1 / fixed_yielding(body, contact.triangle, contact.barycentric);
  const double closing = -row.normal.dot(row.probe_velocity);
  row.normal_impulse = h * stiffness * std::max(0.0, h * closing - row.gap);
  if (!(row.normal_impulse > 0)) return {};
  row.tangential_impulse += h * h * stiffness * row.probe_velocity;
  take_guess(row);
  return {-row.normal_impulse * row.normal, row.tangential_impulse};
}

}  // namespace palpate::deformation
