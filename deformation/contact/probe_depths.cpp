// What keeps tissue out of a round probe that comes over it within one step: where the step's
// rows were found nothing touched there yet.
#include <algorithm>

#include "deformation/contact/probe_contacts.h"

namespace palpate::deformation {
namespace {

/// Nearest places of neighbours, on the edge or corner they share, are one [m].
constexpr double kOnePlace = 1e-6;

bool is_seen_within(const NearTriangle& triangle, double distance) {
  return triangle.facing > 0 && triangle.pair.distance < distance;
}

}  // namespace

/// How far it, and tissue near it, went in the sub-step, together [m].
double ProbeContacts::way_to_tissue(const SurfaceWalk& surface, std::span<const Vec3> start,
                                    std::span<const Vec3> end, const Pose& before,
                                    const Pose& after) const {
  const auto way_of = [&](const Vec3& p) {
    return (after.to_world(p) - before.to_world(p)).norm();
  };
  double moved = 0;
  for (const std::uint32_t triangle : seeds_) {
    for (const std::uint32_t node : surface.body().triangles[triangle]) {
      moved = std::max(moved, (end[node] - start[node]).norm());
    }
  }
  return moved + std::max(way_of(core_->a), way_of(core_->b));
}

/// Has the place a row, or that of a neighbour which shares the edge or corner it is on?
bool ProbeContacts::is_held(std::uint32_t organ, const Vec3& place, std::span<const Vec3> end,
                            std::span<const ContactRow> rows) const {
  return std::ranges::any_of(contacts_, [&](const CarriedContact& contact) {
    return contact.organ == organ && contact.row != CarriedContact::kNoRow &&
           (at_tissue(rows[contact.row], end) - place).norm() < kOnePlace;
  });
}

bool ProbeContacts::hold_swallowed(std::uint32_t organ, SurfaceWalk& surface,
                                   std::span<const Vec3> start, std::span<const Vec3> end, double h,
                                   double fraction, std::vector<ContactRow>& rows) {
  if (!may_cross(organ) || near_of(organ).inside) return false;
  const Pose before = pose_at(fraction - h / period_), after = pose_at(fraction);
  take_seeds(near_of(organ));
  const double way = way_to_tissue(surface, start, end, before, after);
  if (way <= kUnsolvedDepth) return false;
  const Vec3 a = after.to_world(core_->a), b = after.to_world(core_->b);
  if (way > kTouched) surface.append_near(a, b, end, core_->radius, seeds_);
  surface.find(a, b, end, seeds_, core_->radius + kTouched, found_);
  const bool swallowed = std::ranges::any_of(found_, [&](const NearTriangle& found) {
    return is_seen_within(found, core_->radius - kUnsolvedDepth);
  });
  if (!swallowed) return false;
  const std::size_t had = rows.size();
  const bool gentle = is_gentle(organ);
  for (const NearTriangle& found : found_) {
    if (!is_seen_within(found, core_->radius)) continue;
    if (is_held(organ, found.pair.on_triangle.point, end, rows)) continue;
    if (is_yielding_held(organ, found.index, rows)) continue;
    CarriedContact contact;
    contact.organ = organ;
    contact.triangle = found.index;
    contact.barycentric = found.pair.on_triangle.weights;
    contact.normal_P = after.rotation.conjugate() * found.away;
    contact.point_P = after.to_body(found.pair.on_segment - core_->radius * found.away);
    if (is_on_fixed_nodes(contact, surface.body())) continue;
    const ContactRow row = row_of(contact, surface.body(), start, before, after, h);
    if (gentle && row.gap < 0) continue;  // it was in before, and goes out gently
    add_row(contact, row, rows);
  }
  return rows.size() > had;
}

}  // namespace palpate::deformation
