// What touches tissue on fixed nodes.
#include <algorithm>
#include <cmath>
#include <vector>

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
  const double stiffness =
      contact.fixed_share / fixed_yielding(body, contact.triangle, contact.barycentric);
  const double closing = -row.normal.dot(row.probe_velocity);
  row.normal_impulse = h * stiffness * std::max(0.0, h * closing - row.gap);
  if (!(row.normal_impulse > 0)) return {};
  row.tangential_impulse += h * h * stiffness * row.probe_velocity;
  take_guess(row);
  return {-row.normal_impulse * row.normal, row.tangential_impulse};
}

/// Each triangle resists as one block does, however many corners and edges of a sharp tool press on
/// it: nearly as with the deepest of them, k (Σ d⁴)^¼ in all, which grows as any comes deeper, and
/// of which each has its part. Where tissue can move, too, none has less than an equal part: what
/// comes to it is held from the first.
void ProbeContacts::share_fixed(std::uint32_t organ, const Body& body,
                                std::span<const Vec3> positions, const Pose& before,
                                const Pose& after, double h) {
  constexpr double kLeastShare = 1e-6;
  std::vector<double> depths;
  for (std::size_t first = 0, end = 0; first < contacts_.size(); first = end) {
    end = first + 1;
    while (end < contacts_.size() && triangle_of(contacts_[end]) == triangle_of(contacts_[first])) {
      ++end;
    }
    const std::span<CarriedContact> on_one(contacts_.data() + first, end - first);
    if (contacts_[first].organ != organ || on_one.size() < 2) continue;
    const auto is_fixed = [&](std::uint32_t node) { return body.inverse_masses[node] == 0; };
    if (std::ranges::none_of(body.triangles[contacts_[first].triangle], is_fixed)) continue;
    double sum = 0;
    depths.clear();
    for (const CarriedContact& contact : on_one) {
      const ContactRow row = row_of(contact, body, positions, before, after, h);
      const double closing = -row.normal.dot(row.probe_velocity);
      depths.push_back(row.yielding > 0 ? std::max(0.0, h * closing - row.full_gap) : 0);
      sum += std::pow(depths.back(), 4);
    }
    const double whole = std::pow(sum, 0.25), equal = 1.0 / static_cast<double>(on_one.size());
    for (std::size_t i = 0; i < on_one.size(); ++i) {
      const double least = is_on_fixed_nodes(on_one[i], body) ? kLeastShare : equal;
      on_one[i].fixed_share = whole > 0 ? std::max(least, std::pow(depths[i] / whole, 3)) : 1;
    }
  }
}

}  // namespace palpate::deformation
