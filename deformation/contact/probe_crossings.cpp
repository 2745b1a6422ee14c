// What keeps a round probe's core on the outer side of a wall.
#include <algorithm>
#include <utility>

#include "deformation/contact/probe_contacts.h"

namespace palpate::deformation {

void ProbeContacts::begin_change(std::uint32_t organ, const SurfaceWalk& surface,
                                 std::span<const Vec3> positions, std::vector<CoreLine>& cores) {
  const auto line_of = [&](const geometry::RoundedSegment& core) {
    return CoreLine{start_.to_world(core.a), start_.to_world(core.b)};
  };
  deepest_ = is_gentle(organ) ? deepest_tissue(organ, surface, positions) : 0;
  const auto near = std::ranges::find(near_, organ, &Near::organ);
  if (core_ && near != near_.end() && !near->inside) cores.push_back(line_of(*core_));
  if (!has_contacts(organ) || is_gentle(organ)) return;
  for (const geometry::RoundedSegment& core : inner_cores_) {
    const CoreLine line = line_of(core);
    if (are_outside({&line, 1}, surface.body(), positions)) cores.push_back(line);
  }
}

void ProbeContacts::append_crossed(std::uint32_t organ, SurfaceWalk& surface,
                                   std::span<const Vec3> positions, double fraction,
                                   std::vector<CoreLine>& cores) {
  if (!may_cross(organ)) return;
  Near& near = near_of(organ);
  const auto out = std::ranges::find(gentle_, organ, &GentlePush::organ);
  if (out != gentle_.end() && out->core_was_inside()) return;
  const Pose pose = pose_at(fraction);
  const CoreLine core{pose.to_world(core_->a), pose.to_world(core_->b)};
  if (!near.crossed) {
    if (near.inside || core_->is_ball()) return;
    take_seeds(near);
    near.crossed = surface.is_cut(core.a, core.b, positions, seeds_, core_->radius + kTouched);
  }
  if (near.crossed) cores.push_back(core);
}

bool ProbeContacts::put_back_outside(std::span<ProbeContacts> probes, std::uint32_t organ,
                                     SurfaceWalk& surface, std::span<Vec3> positions,
                                     double fraction) {
  std::vector<CoreLine> cores;
  for (ProbeContacts& probe : probes) {
    probe.append_crossed(organ, surface, positions, fraction, cores);
  }
  if (cores.empty()) return false;
  const bool crossed = !are_outside(cores, surface.body(), positions);
  const bool outside = !crossed || seat_outside(cores, surface.body(), positions);
  for (ProbeContacts& probe : probes) {
    if (!probe.may_cross(organ)) continue;
    Near& near = probe.near_of(organ);
    if (std::exchange(near.crossed, false)) near.inside = !outside;
  }
  return true;
}

CoreWay ProbeContacts::way_of(const geometry::RoundedSegment& core, const Pose& before,
                              const Pose& after) {
  return {before.to_world(core.a), before.to_world(core.b), after.to_world(core.a),
          after.to_world(core.b)};
}

/// Ends of the core through triangles, and its side over edges: crossings_.
void ProbeContacts::find_crossings(SurfaceWalk& surface, std::span<const Vec3> start,
                                   std::span<const Vec3> end, const CoreWay& core) {
  const bool is_ball = core.a0 == core.b0;
  crossings_.clear();
  if (!is_ball) surface.find_side_crossings(core, start, end, seeds_, crossings_);
  if (const auto a = surface.first_crossing(core.a0, core.a1, start, end, seeds_)) {
    crossings_.push_back(*a);
  }
  if (is_ball) return;
  if (const auto b = surface.first_crossing(core.b0, core.b1, start, end, seeds_)) {
    crossings_.push_back(*b);
    crossings_.back().along = 1;
  }
}

void ProbeContacts::put_at(const WallCrossing& crossing, const geometry::RoundedSegment& core,
                           const Pose& pose, CarriedContact& contact) {
  contact.barycentric = crossing.weights;
  contact.normal_P = pose.rotation.conjugate() * crossing.normal;
  contact.point_P = core.a + crossing.along * (core.b - core.a) - core.radius * contact.normal_P;
}

/// A row where the core went through, or in the place of that triangle's.
/// @returns false if that holds no more than what is: a wall that is fixed, all or in part, yields
bool ProbeContacts::hold_at(const WallCrossing& crossing, std::uint32_t organ,
                            const SurfaceWalk& surface, std::span<const Vec3> start,
                            const Pose& before, const Pose& after, double h,
                            std::vector<ContactRow>& rows) {
  CarriedContact& contact = contact_on(organ, crossing.triangle);
  put_at(crossing, *core_, after, contact);
  if (is_on_fixed_nodes(contact, surface.body())) return false;
  ContactRow row = row_of(contact, surface.body(), start, before, after, h);
  if (contact.row == CarriedContact::kNoRow) {
    contact.row = rows.size();
    rows.push_back(row);
    return true;
  }
  row.normal_impulse = rows[contact.row].normal_impulse;
  row.tangential_impulse = rows[contact.row].tangential_impulse;
  rows[contact.row] = row;
  return row.yielding == 0;
}

Missed ProbeContacts::hold_missed(std::span<ProbeContacts> probes, std::uint32_t organ,
                                  SurfaceWalk& surface, std::span<const Vec3> start,
                                  std::span<const Vec3> end, double h, double fraction,
                                  std::vector<ContactRow>& rows) {
  Missed missed = Missed::kNothing;
  for (ProbeContacts& probe : probes) {
    if (probe.hold_crossed(organ, surface, start, end, h, fraction, rows) ||
        probe.hold_pierced(organ, surface, start, end, h, fraction, rows)) {
      missed = Missed::kCrossing;
    } else {
      missed =
          std::max(missed, probe.hold_swallowed(organ, surface, start, end, h, fraction, rows));
    }
  }
  return missed;
}

bool ProbeContacts::hold_crossed(std::uint32_t organ, SurfaceWalk& surface,
                                 std::span<const Vec3> start, std::span<const Vec3> end, double h,
                                 double fraction, std::vector<ContactRow>& rows) {
  if (!may_cross(organ) || near_of(organ).inside) return false;
  const Pose before = pose_at(fraction - h / period_), after = pose_at(fraction);
  take_seeds(near_of(organ));
  find_crossings(surface, start, end, way_of(*core_, before, after));
  Near& near = near_of(organ);
  near.crossed = near.went_through = false;
  for (const WallCrossing& crossing : crossings_) {
    (fixed_yielding(surface.body(), crossing.triangle, crossing.weights) > 0 ? near.went_through
                                                                             : near.crossed) = true;
  }
  // A core on its gentle way out may swing back in; it is not kept from it at a blow.
  const auto out = std::ranges::find(gentle_, organ, &GentlePush::organ);
  if (out != gentle_.end() && out->core_was_inside()) return false;
  bool holds = false;
  for (const WallCrossing& crossing : crossings_) {
    holds |= hold_at(crossing, organ, surface, start, before, after, h, rows);
  }
  return holds;
}

}  // namespace palpate::deformation
