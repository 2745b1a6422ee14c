// What keeps tissue out of a round probe that comes over it within one step: where the step's
// rows were found nothing touched there yet.
#include <algorithm>
#include <cmath>

#include "deformation/contact/probe_contacts.h"
#include "modules/core/sort_unique.h"

namespace palpate::deformation {
namespace {

/// Nearest places of neighbours, on the edge or corner they share, are one [m].
constexpr double kOnePlace = 1e-6;

bool is_seen_within(const NearTriangle& triangle, double distance) {
  return triangle.facing > 0 && triangle.pair.distance < distance;
}

/// Of the node that moved most, wherever it is [m].
double longest_way(std::span<const Vec3> start, std::span<const Vec3> end) {
  double longest = 0;
  for (std::size_t i = 0; i < start.size(); ++i) {
    longest = std::max(longest, (end[i] - start[i]).squaredNorm());
  }
  return std::sqrt(longest);
}

}  // namespace

double ProbeContacts::deepest_tissue(std::uint32_t organ, const SurfaceWalk& surface,
                                     std::span<const Vec3> positions) const {
  const auto near = std::ranges::find(near_, organ, &Near::organ);
  if (!core_ || near == near_.end() || near->inside) return 0;
  const Vec3 a = start_.to_world(core_->a), b = start_.to_world(core_->b);
  std::vector<std::uint32_t> touched;
  surface.append_near(a, b, positions, core_->radius, touched);
  double deepest = 0;
  for (const std::uint32_t triangle : touched) {
    const NearTriangle found = surface.triangle_near(triangle, a, b, positions);
    if (found.facing > 0) deepest = std::max(deepest, core_->radius - found.pair.distance);
  }
  return deepest;
}

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

/// The row of the place, or of a neighbour which shares the edge or corner it is on, if there is
/// one.
const ContactRow* ProbeContacts::row_at(std::uint32_t organ, const Vec3& place,
                                        std::span<const Vec3> end,
                                        std::span<const ContactRow> rows) const {
  for (const CarriedContact& contact : contacts_) {
    if (contact.organ != organ || contact.row == CarriedContact::kNoRow) continue;
    const ContactRow& row = rows[contact.row];
    if ((at_tissue(row, end) - place).norm() < kOnePlace) return &row;
  }
  return nullptr;
}

Missed ProbeContacts::hold_swallowed(std::uint32_t organ, SurfaceWalk& surface,
                                     std::span<const Vec3> start, std::span<const Vec3> end,
                                     double h, double fraction, std::vector<ContactRow>& rows) {
  if (!may_cross(organ) || near_of(organ).inside) return Missed::kNothing;
  const Pose before = pose_at(fraction - h / period_), after = pose_at(fraction);
  take_seeds(near_of(organ));
  const double way = way_to_tissue(surface, start, end, before, after);
  // Tissue that is flung from elsewhere comes to a probe that nothing near it tells of.
  const std::size_t nodes = surface.body().surface_node_count;
  const bool from_afar =
      way > kTouched || longest_way(start.first(nodes), end.first(nodes)) > kTouched;
  if (way <= kUnsolvedDepth && !from_afar) return Missed::kNothing;
  const Vec3 a = after.to_world(core_->a), b = after.to_world(core_->b);
  if (from_afar) {
    std::vector<std::uint32_t>& near = near_of(organ).triangles;
    surface.append_near(a, b, end, core_->radius + kTouched, near);
    sort_unique(near);
    seeds_.insert(seeds_.end(), near.begin(), near.end());
  }
  surface.find(a, b, end, seeds_, core_->radius + kTouched, found_);
  const bool swallowed = std::ranges::any_of(found_, [&](const NearTriangle& found) {
    return is_seen_within(found, core_->radius - kUnsolvedDepth);
  });
  if (!swallowed) return Missed::kNothing;
  const std::size_t had = rows.size();
  const bool gentle = is_gentle(organ);
  bool deeper = false;
  for (const NearTriangle& found : found_) {
    if (!is_seen_within(found, core_->radius)) continue;
    const double depth = core_->radius - found.pair.distance;
    if (const ContactRow* row = row_at(organ, found.pair.on_triangle.point, end, rows)) {
      deeper |= depth > kUnsolvedDepth && !gentle && row->yielding == 0;
      continue;
    }
    if (is_yielding_held(organ, found.index, rows)) continue;
    CarriedContact contact;
    contact.organ = organ;
    contact.triangle = found.index;
    contact.barycentric = found.pair.on_triangle.weights;
    contact.normal_P = after.rotation.conjugate() * found.away;
    contact.point_P = after.to_body(found.pair.on_segment - core_->radius * found.away);
    if (is_on_fixed_nodes(contact, surface.body())) continue;
    const ContactRow row = row_of(contact, surface.body(), start, before, after, h);
    if (gentle && row.gap < 0) {  // it was in before, and goes out gently
      deeper |= depth > kUnsolvedDepth - row.gap;
      continue;
    }
    add_row(contact, row, rows);
  }
  if (rows.size() > had) return Missed::kDepth;
  return deeper ? Missed::kDeeper : Missed::kNothing;
}

}  // namespace palpate::deformation
