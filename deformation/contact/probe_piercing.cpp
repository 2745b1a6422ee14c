// What keeps a wall from going through a sharp tool within one step.
#include <algorithm>
#include <cmath>

#include "deformation/contact/probe_contacts.h"
#include "modules/core/sort_unique.h"

namespace palpate::deformation {

void ProbeContacts::add_row(CarriedContact contact, const ContactRow& row,
                            std::vector<ContactRow>& rows) {
  contact.row = rows.size();
  rows.push_back(row);
  contacts_.insert(std::ranges::upper_bound(contacts_, triangle_of(contact), {}, triangle_of),
                   contact);
}

/// By the face that a node came through. One that was as deep before goes out gently.
void ProbeContacts::hold_nodes_in_box(std::uint32_t organ, std::span<const std::uint32_t> triangles,
                                      const SurfaceWalk& surface, std::span<const Vec3> start,
                                      std::span<const Vec3> end, const Pose& before,
                                      const Pose& after, double h, std::vector<ContactRow>& rows) {
  std::vector<std::uint32_t> seen;
  for (const std::uint32_t t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t node = surface.body().triangles[t][static_cast<std::size_t>(k)];
      const Vec3 at = after.to_body(end[node]), was = before.to_body(start[node]);
      const Vec3 outside = was.cwiseAbs() - *half_extents_;
      if ((at.cwiseAbs() - *half_extents_).maxCoeff() > -kUnsolvedDepth) continue;
      if (outside.maxCoeff() < -kUnsolvedDepth) continue;
      if (surface.body().inverse_masses[node] == 0) continue;
      if (std::ranges::find(seen, node) != seen.end()) continue;
      seen.push_back(node);
      Eigen::Index axis = 0;
      outside.maxCoeff(&axis);
      CarriedContact contact;
      contact.organ = organ;
      contact.triangle = t;
      contact.barycentric = Vec3::Unit(k);
      contact.normal_P = -std::copysign(1.0, was[axis]) * Vec3::Unit(axis);
      contact.point_P = at;
      contact.point_P[axis] = std::copysign((*half_extents_)[axis], was[axis]);
      add_row(contact, row_of(contact, surface.body(), start, before, after, h), rows);
    }
  }
}

/// A triangle that yields, and has a row, is held as well as it can be.
bool ProbeContacts::is_yielding_held(std::uint32_t organ, std::uint32_t triangle,
                                     std::span<const ContactRow> rows) const {
  return std::ranges::any_of(contacts_, [&](const CarriedContact& contact) {
    return contact.organ == organ && contact.triangle == triangle &&
           contact.row != CarriedContact::kNoRow && rows[contact.row].yielding > 0;
  });
}

bool ProbeContacts::hold_pierced(std::uint32_t organ, SurfaceWalk& surface,
                                 std::span<const Vec3> start, std::span<const Vec3> end, double h,
                                 double fraction, std::vector<ContactRow>& rows) {
  // What is inside on its gentle way out may swing back in; it is not kept from it at a blow.
  if (inner_cores_.empty() || !has_contacts(organ) || is_gentle(organ)) return false;
  const Pose before = pose_at(fraction - h / period_), after = pose_at(fraction);
  std::vector<std::uint32_t> touched;
  for (const CarriedContact& contact : contacts_) {
    if (contact.organ == organ) touched.push_back(contact.triangle);
  }
  sort_unique(touched);
  std::vector<std::uint32_t> near = touched;
  const std::size_t had = rows.size();
  for (const geometry::RoundedSegment& core : inner_cores_) {
    const CoreWay way = way_of(core, before, after);
    surface.find(way.a0, way.b0, start, touched, kTouched, found_);
    if (is_behind_nearest(found_)) continue;
    seeds_ = touched;
    for (const NearTriangle& found : found_) {
      seeds_.push_back(found.index);
      near.push_back(found.index);
    }
    find_crossings(surface, start, end, way);
    for (const WallCrossing& crossing : crossings_) {
      CarriedContact contact;
      contact.organ = organ;
      contact.triangle = crossing.triangle;
      put_at(crossing, core, after, contact);
      if (is_on_fixed_nodes(contact, surface.body())) continue;
      if (is_yielding_held(organ, crossing.triangle, rows)) continue;
      add_row(contact, row_of(contact, surface.body(), start, before, after, h), rows);
    }
  }
  if (half_extents_) {
    sort_unique(near);
    hold_nodes_in_box(organ, near, surface, start, end, before, after, h, rows);
  }
  return rows.size() > had;
}

}  // namespace palpate::deformation
