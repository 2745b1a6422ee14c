#include "deformation/contact/probe_contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "deformation/contact/inner_cores.h"
#include "modules/core/sort_unique.h"
#include "modules/core/tolerances.h"

namespace palpate::deformation {
namespace {

/// A probe whose way in a period is shorter rests [m].
constexpr double kResting = 1e-6;

/// Contacts on one triangle, in barycentric coordinates as far from each other as two nodes, are
/// two.
constexpr double kSamePlace = 0.99;

double apart(const CarriedContact& a, const CarriedContact& b) {
  return (a.barycentric - b.barycentric).lpNorm<Eigen::Infinity>();
}

}  // namespace

ProbeContacts::ProbeContacts(const scene::Probe& probe, const geometry::TriangleSurface& mesh)
    : friction_(probe.friction), inner_cores_(inner_cores(probe.shape, mesh)) {
  const geometry::ProbeForm form = scene::form_of(probe.shape);
  if (const auto* core = std::get_if<geometry::RoundedSegment>(&form)) core_ = *core;
  is_sharp_ = !core_ && !std::holds_alternative<geometry::HalfSpace>(form);
  if (const auto* box = std::get_if<geometry::Box>(&form)) half_extents_ = box->size / 2;
}

void ProbeContacts::reset() {
  placed_ = false;
  forget_contacts();
}

void ProbeContacts::forget_contacts() {
  searched_ = false;
  contacts_.clear();
  near_.clear();
  gentle_.clear();
  begun_.clear();
}

void ProbeContacts::set_pose(const Pose& pose, double kept_within) {
  const auto way_of = [&](const Vec3& p) {
    return (pose.to_world(p) - target_.to_world(p)).norm();
  };
  const double way = core_ ? std::max(way_of(core_->a), way_of(core_->b)) : way_of(Vec3::Zero());
  if (placed_ && way > kept_within) forget_contacts();
  target_ = pose;
  if (!placed_) start_ = pose;
  placed_ = true;
}

void ProbeContacts::set_contacts(std::span<const Contact> newest) {
  std::swap(previous_contacts_, contacts_);
  contacts_.clear();
  searched_ = true;
  found_at_ = target_;
  for (const Contact& contact : newest) {
    CarriedContact& carried = contacts_.emplace_back(contact);
    carried.behind = core_ && is_behind(contact);
    take_forces_of_previous(carried);
  }
  note_begun();
}

/// Of the nearest on its triangle, where a round probe has but one; each is taken once.
void ProbeContacts::take_forces_of_previous(CarriedContact& carried) {
  const auto triangle = triangle_of(carried);
  CarriedContact* nearest = nullptr;
  for (auto at = std::ranges::lower_bound(previous_contacts_, triangle, {}, triangle_of);
       at != previous_contacts_.end() && triangle_of(*at) == triangle; ++at) {
    CarriedContact& previous = *at;
    if (!core_ && apart(previous, carried) > kSamePlace) continue;
    if (!nearest || apart(previous, carried) < apart(*nearest, carried)) nearest = &previous;
  }
  if (!nearest) return;
  carried.normal_force = std::exchange(nearest->normal_force, 0);
  carried.tangential_force = std::exchange(nearest->tangential_force, Vec3::Zero());
}

bool ProbeContacts::change_surface(std::uint32_t organ, const geometry::SurfaceTransfer& transfer,
                                   const SurfaceWalk& surface, std::span<const Vec3> positions) {
  for (Near& near : near_) {
    if (near.organ != organ) continue;
    for (std::uint32_t& triangle : near.triangles) {
      triangle = transfer.place({triangle, Vec3::Constant(1.0 / 3)}).triangle;
    }
    // Flat triangles in the place of others may have come as near from another fold.
    if (near.watched && !near.inside) {
      surface.append_near(start_.to_world(core_->a), start_.to_world(core_->b), positions,
                          core_->radius + kTouched, near.triangles);
    }
    sort_unique(near.triangles);
  }
  for (CarriedContact& contact : contacts_) {
    if (contact.organ != organ) continue;
    const auto moved = transfer.place({contact.triangle, contact.barycentric});
    contact.triangle = moved.triangle;
    contact.barycentric = moved.weights;
  }
  std::ranges::stable_sort(contacts_, {}, triangle_of);
  if (core_) unite_contacts(organ);
  return is_gentle(organ) &&
         deepest_tissue(organ, surface, positions) > std::max(deepest_, kUnsolvedDepth);
}

/// Of a round probe there is one to a triangle; what several did is its.
void ProbeContacts::unite_contacts(std::uint32_t organ) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (kept > 0 && contacts_[i].organ == organ &&
        triangle_of(contacts_[kept - 1]) == triangle_of(contacts_[i])) {
      CarriedContact& one = contacts_[kept - 1];
      one.normal_force += contacts_[i].normal_force;
      one.tangential_force += contacts_[i].tangential_force;
      one.behind |= contacts_[i].behind;
      one.pushed += contacts_[i].pushed;
      one.dragged += contacts_[i].dragged;
    } else {
      if (kept != i) contacts_[kept] = contacts_[i];
      ++kept;
    }
  }
  contacts_.erase(contacts_.begin() + static_cast<std::ptrdiff_t>(kept), contacts_.end());
}

/// Whether the search found the core on the inner side of the contact's tissue.
bool ProbeContacts::is_behind(const Contact& contact) const {
  const Vec3 tissue = contact.point_P - contact.gap * contact.normal_P;
  const Vec3 along = core_->b - core_->a;
  const double length = along.squaredNorm();
  const double at = length > 0 ? std::clamp(along.dot(tissue - core_->a) / length, 0.0, 1.0) : 0;
  return contact.normal_P.dot(core_->a + at * along - tissue) < 0;
}

/// Organs that the probe was away from, until a step looks at them.
void ProbeContacts::note_begun() {
  const auto among = [](const std::vector<CarriedContact>& contacts, std::uint32_t organ) {
    return std::ranges::find(contacts, organ, &CarriedContact::organ) != contacts.end();
  };
  std::erase_if(gentle_, [&](const GentlePush& g) { return !among(contacts_, g.organ()); });
  std::erase_if(near_, [&](const Near& n) { return !n.watched && !among(contacts_, n.organ); });
  std::erase_if(begun_, [&](std::uint32_t organ) { return !among(contacts_, organ); });
  for (const CarriedContact& contact : contacts_) {
    const bool known =
        std::ranges::find(begun_, contact.organ) != begun_.end() || is_kept_outside(contact.organ);
    if (!known && !among(previous_contacts_, contact.organ)) begun_.push_back(contact.organ);
  }
}

/// Bounds how fast an organ's penetration is undone if it was not seen coming.
/// @param rows  of the organ, at the beginning of a sub-step of h
void ProbeContacts::be_gentle(std::uint32_t organ, const OrganState& state, double h,
                              std::span<ContactRow> rows) {
  auto gentle = std::ranges::find(gentle_, organ, &GentlePush::organ);
  if (std::erase(begun_, organ) > 0 && gentle == gentle_.end() &&
      deepest_of(rows) > GentlePush::kSeenDepth + way()) {
    gentle = gentle_.insert(gentle_.end(), GentlePush(organ));
  }
  if (gentle == gentle_.end()) return;
  if (!gentle->soften(state, h, core_ && near_of(organ).inside, rows)) gentle_.erase(gentle);
}

bool ProbeContacts::is_gentle(std::uint32_t organ) const {
  return std::ranges::find(gentle_, organ, &GentlePush::organ) != gentle_.end();
}

bool ProbeContacts::begin(double period) {
  period_ = period;
  for (CarriedContact& contact : contacts_) contact.pushed = contact.dragged = Vec3::Zero();
  if (way() <= kMaxProbeSpeed * period) return true;
  start_ = target_;
  contacts_.clear();
  near_.clear();
  searched_ = false;
  return false;
}

void ProbeContacts::end() {
  went_ = target_.position - start_.position;
  start_ = target_;
}

Pose ProbeContacts::pose_at(double fraction) const {
  return {start_.position + fraction * (target_.position - start_.position),
          start_.rotation.slerp(fraction, target_.rotation)};
}

Pose ProbeContacts::ahead(double advances) const {
  Vec3 on = advances * (target_.position - start_.position);
  if (radius() > 0 && on.norm() > radius()) on *= radius() / on.norm();
  return {target_.position + on, target_.rotation};
}

ProbeContacts::Near& ProbeContacts::near_of(std::uint32_t organ) {
  const auto at = std::ranges::find(near_, organ, &Near::organ);
  if (at != near_.end()) return *at;
  near_.emplace_back().organ = organ;
  return near_.back();
}

/// The one there is, or a new one: contacts are sorted by (organ, triangle).
CarriedContact& ProbeContacts::contact_on(std::uint32_t organ, std::uint32_t triangle) {
  const auto at = std::ranges::lower_bound(contacts_, std::pair(organ, triangle), {}, triangle_of);
  if (at != contacts_.end() && triangle_of(*at) == std::pair(organ, triangle)) return *at;
  CarriedContact contact;
  contact.organ = organ;
  contact.triangle = triangle;
  return *contacts_.insert(at, contact);
}

/// Folds of a wall are near in space, not over shared nodes: the search found them, too.
void ProbeContacts::take_seeds(const Near& near) {
  seeds_ = near.triangles;
  for (const CarriedContact& contact : contacts_) {
    if (contact.organ == near.organ) seeds_.push_back(contact.triangle);
  }
}

void ProbeContacts::look_around(std::uint32_t organ, SurfaceWalk& surface, const OrganState& state,
                                const Pose& pose) {
  Near& near = near_of(organ);
  take_seeds(near);
  surface.find(pose.to_world(core_->a), pose.to_world(core_->b), state.positions, seeds_,
               core_->radius + kTouched, found_);
  const bool found_behind = std::ranges::any_of(contacts_, [&](const CarriedContact& contact) {
    return contact.organ == organ && contact.behind;
  });
  // A search that saw a resting probe inside knows better, unless it was of an earlier wall.
  if (near.inside) {
    near.inside = is_behind_nearest(found_);
  } else if (found_behind && way() < kResting && is_behind_nearest(found_)) {
    const CoreLine core{pose.to_world(core_->a), pose.to_world(core_->b)};
    near.inside = !are_outside(std::span(&core, 1), surface.body(), state.positions);
  }
  near.crossed = near.went_through = near.watched = false;
  near.triangles.clear();
  for (const NearTriangle& found : found_) {
    near.watched |= found.pair.distance <= core_->radius + kWatched + way();
    near.triangles.push_back(found.index);
    const bool touched = found.facing > 0 && found.pair.distance <= core_->radius + kTouched;
    if (!near.inside && touched) contact_on(organ, found.index);
  }
}

/// A probe that starts in a hurry reaches the wall before the next search does, and another fold of
/// the wall may have come nearer than what it is near.
void ProbeContacts::watch_from_afar(std::uint32_t organ, SurfaceWalk& surface,
                                    const OrganState& state, const Pose& pose) {
  const Vec3 a = pose.to_world(core_->a), b = pose.to_world(core_->b);
  const auto seeds = surface.around(surface.nearest_node(a, b, state.positions));
  if (knows(organ)) {
    auto& triangles = near_of(organ).triangles;
    triangles.insert(triangles.end(), seeds.begin(), seeds.end());
    return;
  }
  surface.find(a, b, state.positions, seeds, 0, found_);
  const bool clear = std::ranges::all_of(found_, [&](const NearTriangle& found) {
    return found.pair.distance > core_->radius && found.facing > 0;
  });
  if (!clear) return;
  Near& near = near_of(organ);
  for (const NearTriangle& found : found_) near.triangles.push_back(found.index);
}

bool ProbeContacts::measure_again(const SurfaceWalk& surface, const OrganState& state,
                                  const Pose& pose, bool inside, CarriedContact& contact) const {
  const NearTriangle near = surface.triangle_near(contact.triangle, pose.to_world(core_->a),
                                                  pose.to_world(core_->b), state.positions);
  // A core that touches the triangle has no direction to it: the last one stays, if there was one.
  if (!(near.pair.distance > 1e-3 * core_->radius)) return !contact.barycentric.isZero(0);
  const bool came_through = inside && near.away.dot(pose.rotation * contact.normal_P) < 0;
  if (near.facing <= 0 && !came_through) return false;
  const Vec3 normal = near.facing > 0 ? near.away : -near.away;
  contact.barycentric = near.pair.on_triangle.weights;
  contact.normal_P = pose.rotation.conjugate() * normal;
  contact.point_P = pose.to_body(near.pair.on_segment - core_->radius * normal);
  return true;
}

Vec3 ProbeContacts::impulse() const {
  Vec3 sum = Vec3::Zero();
  for (const CarriedContact& contact : contacts_) sum += contact.pushed + contact.dragged;
  return sum;
}

bool ProbeContacts::holds_on(double within) const {
  return core_ || std::ranges::all_of(contacts_, [&](const CarriedContact& contact) {
           const Vec3& p = contact.point_P;
           return (target_.to_world(p) - found_at_.to_world(p)).norm() <= within;
         });
}

bool ProbeContacts::has_contacts(std::uint32_t organ) const {
  return std::ranges::find(contacts_, organ, &CarriedContact::organ) != contacts_.end();
}

bool ProbeContacts::knows(std::uint32_t organ) const {
  return std::ranges::find(near_, organ, &Near::organ) != near_.end();
}

bool ProbeContacts::is_watched(std::uint32_t organ) const {
  const auto at = std::ranges::find(near_, organ, &Near::organ);
  return at != near_.end() && at->watched;
}

/// A wall whose every sub-step is looked at is seen coming, whatever searches found meanwhile.
bool ProbeContacts::is_kept_outside(std::uint32_t organ) const {
  const auto at = std::ranges::find(near_, organ, &Near::organ);
  return at != near_.end() && at->watched && !at->inside;
}

bool ProbeContacts::touches(std::uint32_t organ) const {
  return std::any_of(contacts_.begin(), contacts_.end(), [&](const CarriedContact& contact) {
    return contact.organ == organ && contact.normal_force > 0;
  });
}

}  // namespace palpate::deformation
