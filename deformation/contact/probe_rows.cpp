// The rows of a probe's contacts in a sub-step, and what they gave.
#include <algorithm>

#include "deformation/contact/probe_contacts.h"

namespace palpate::deformation {
namespace {

/// A sharp tool's contacts are those of a search, earlier than the step: what they find deep is
/// undone no faster than this, else it swings, is found deep again and never comes to rest [m/s].
constexpr double kSharpSeparationSpeed = 0.1;

}  // namespace

ContactRow ProbeContacts::row_of(const CarriedContact& contact, const Body& body,
                                 std::span<const Vec3> positions, const Pose& before,
                                 const Pose& after, double h) const {
  ContactRow row;
  row.nodes = body.triangles[contact.triangle];
  row.weights = contact.barycentric;
  row.normal = after.rotation * contact.normal_P;
  const Vec3 point = before.to_world(contact.point_P);
  row.gap = row.normal.dot(point - at_tissue(row, positions));
  row.probe_velocity = (after.to_world(contact.point_P) - point) / h;
  row.friction = friction_;
  row.radius = radius();
  row.yielding = fixed_yielding(body, contact.triangle, contact.barycentric) / contact.fixed_share;
  row.full_gap = row.gap;
  row.normal_impulse = h * contact.normal_force;
  row.tangential_impulse = h * contact.tangential_force;
  return row;
}

void ProbeContacts::append_rows(std::uint32_t organ, SurfaceWalk& surface, const OrganState& state,
                                double h, double fraction, std::vector<ContactRow>& rows) {
  const Pose before = pose_at(fraction - h / period_), after = pose_at(fraction);
  const std::size_t first = rows.size();
  const bool begins = fraction * period_ < 1.5 * h;
  if (core_ && searched_ && begins && !has_contacts(organ)) {
    watch_from_afar(organ, surface, state, before);
  }
  if (!has_contacts(organ) && !knows(organ)) return;
  if (core_) unite_contacts(organ);
  if (core_) look_around(organ, surface, state, before);
  if (is_sharp_) share_fixed(organ, surface.body(), state.positions, before, after, h);
  const bool inside = core_ && near_of(organ).inside;
  for (CarriedContact& contact : contacts_) {
    if (contact.organ != organ) continue;
    contact.row = CarriedContact::kNoRow;
    contact.on_fixed.reset();
    if (core_ && !measure_again(surface, state, before, inside, contact)) continue;
    if (is_on_fixed_nodes(contact, surface.body())) {
      contact.on_fixed.emplace();
    } else {
      contact.row = rows.size();
      rows.push_back(row_of(contact, surface.body(), state.positions, before, after, h));
    }
  }
  if (!gentle_.empty() || !begun_.empty()) {
    be_gentle(organ, state, h, std::span(rows).subspan(first));
  }
  for (CarriedContact& contact : contacts_) {
    if (contact.organ != organ || !contact.on_fixed) continue;
    ContactRow row = row_of(contact, surface.body(), state.positions, before, after, h);
    // From inside the wall on the other side is as deep as an organ is thick.
    if (is_gentle(organ)) row.gap = std::max(row.gap, -h * kGentleSpeed);
    contact.on_fixed = press_fixed(contact, surface.body(), h, row);
  }
  if (is_sharp_) {
    for (ContactRow& row : std::span(rows).subspan(first)) {
      row.gap = std::max(row.gap, -h * kSharpSeparationSpeed);
    }
  }
}

std::size_t ProbeContacts::take_rows(std::uint32_t organ, double h,
                                     std::span<const ContactRow> rows) {
  std::size_t taken = 0;
  if (may_cross(organ)) {
    Near& near = near_of(organ);
    near.inside |= near.crossed || near.went_through;
  }
  for (CarriedContact& contact : contacts_) {
    if (contact.organ != organ) continue;
    contact.normal_force = 0;
    contact.tangential_force.setZero();
    if (contact.on_fixed) {
      const auto& [normal, tangential] = *contact.on_fixed;
      contact.normal_force = normal.norm() / h;
      contact.tangential_force = tangential / h;
      contact.pushed -= normal;
      contact.dragged -= tangential;
    }
    if (contact.row == CarriedContact::kNoRow) continue;
    const ContactRow& row = rows[contact.row];
    ++taken;
    contact.normal_force = row.normal_impulse / h;
    contact.tangential_force = row.tangential_impulse / h;
    if (row.normal_impulse <= 0) continue;
    contact.pushed += row.normal_impulse * row.normal;
    contact.dragged -= row.tangential_impulse;
  }
  if (core_) unite_contacts(organ);
  return taken;
}

}  // namespace palpate::deformation
