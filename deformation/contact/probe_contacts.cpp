#include "deformation/contact/probe_contacts.h"

#include <algorithm>

#include "modules/core/tolerances.h"
#include "modules/geometry/closest_points.h"

namespace palpate::deformation {
namespace {

bool same_place(const CarriedContact& a, const CarriedContact& b) {
  return a.organ == b.organ && a.triangle == b.triangle;
}

}  // namespace

ProbeContacts::ProbeContacts(const scene::Probe& probe) : friction_(probe.friction) {
  const geometry::ProbeForm form = scene::form_of(probe.shape);
  if (const auto* core = std::get_if<geometry::RoundedSegment>(&form)) core_ = *core;
}

void ProbeContacts::reset() {
  placed_ = false;
  contacts_.clear();
  gentle_.clear();
  begun_.clear();
}

void ProbeContacts::set_pose(const Pose& pose) {
  target_ = pose;
  if (!placed_) start_ = pose;
  placed_ = true;
}

void ProbeContacts::set_contacts(std::span<const Contact> newest) {
  std::swap(previous_contacts_, contacts_);
  contacts_.clear();
  auto previous = previous_contacts_.begin();
  for (const Contact& contact : newest) {
    CarriedContact carried{contact};
    // Both lists are sorted by (organ, triangle).
    while (previous != previous_contacts_.end() && std::pair(previous->organ, previous->triangle) <
                                                       std::pair(carried.organ, carried.triangle)) {
      ++previous;
    }
    if (previous != previous_contacts_.end() && same_place(*previous, carried)) {
      carried.normal_impulse = previous->normal_impulse;
      carried.tangential_impulse = previous->tangential_impulse;
      ++previous;
    }
    contacts_.push_back(carried);
  }
  note_begun();
}

/// Organs that the probe was away from, until a step looks at them.
void ProbeContacts::note_begun() {
  const auto among = [](const std::vector<CarriedContact>& contacts, std::uint32_t organ) {
    return std::ranges::find(contacts, organ, &CarriedContact::organ) != contacts.end();
  };
  std::erase_if(gentle_, [&](const GentleOrgan& g) { return !among(contacts_, g.organ); });
  std::erase_if(begun_, [&](std::uint32_t organ) { return !among(contacts_, organ); });
  for (const CarriedContact& contact : contacts_) {
    const bool known = std::ranges::find(begun_, contact.organ) != begun_.end();
    if (!known && !among(previous_contacts_, contact.organ)) begun_.push_back(contact.organ);
  }
}

/// Bounds how fast an organ's penetration is undone if it was not seen coming: all rows together
/// push as one motion would, along their mean normal. Velocities come to it within kGentleRise:
/// tissue that swings is not stopped at a blow.
/// @param rows  of the organ, at the beginning of a sub-step of h
void ProbeContacts::be_gentle(std::uint32_t organ, const OrganState& state, double h,
                              std::span<ContactRow> rows) {
  double deepest = 0;
  Vec3 outward = Vec3::Zero();
  for (const ContactRow& row : rows) {
    deepest = std::max(deepest, -row.gap);
    outward += std::max(-row.gap, 0.0) * row.normal;
  }
  auto gentle = std::ranges::find(gentle_, organ, &GentleOrgan::organ);
  if (std::erase(begun_, organ) > 0 && gentle == gentle_.end() && deepest > kSeenDepth + way()) {
    gentle = gentle_.insert(gentle_.end(), {organ, 0});
  }
  if (gentle == gentle_.end()) return;
  gentle->time += h;
  if (deepest < kGentleDepth || gentle->time > kGentleTime) {
    gentle_.erase(gentle);
    return;
  }
  const Vec3 push = std::min(kGentleSpeed, deepest / kGentleEnd) * outward.normalized();
  const double change = std::min(1.0, h / kGentleRise);
  for (ContactRow& row : rows) {
    Vec3 velocity = -row.probe_velocity;
    for (int k = 0; k < 3; ++k) velocity += row.weights[k] * state.velocities[row.nodes[k]];
    const double speed = std::max(0.0, row.normal.dot(push));
    const double approach = std::max(row.normal.dot(velocity), -speed);
    row.gap = std::max(row.gap, h * (approach - change * (approach + speed)));
  }
}

bool ProbeContacts::begin(double period) {
  period_ = period;
  for (CarriedContact& contact : contacts_) contact.pushed = contact.dragged = Vec3::Zero();
  if (way() <= kMaxProbeSpeed * period) return true;
  start_ = target_;
  contacts_.clear();
  return false;
}

Pose ProbeContacts::pose_at(double fraction) const {
  return {start_.position + fraction * (target_.position - start_.position),
          start_.rotation.slerp(fraction, target_.rotation)};
}

void ProbeContacts::measure_again(const Body& body, const OrganState& state, const Pose& pose,
                                  CarriedContact& contact) const {
  const auto& nodes = body.triangles[contact.triangle];
  const auto closest = geometry::closest_of_segment_and_triangle(
      pose.to_world(core_->a), pose.to_world(core_->b),
      {state.positions[nodes[0]], state.positions[nodes[1]], state.positions[nodes[2]]});
  // A core that touches the triangle has no direction to it: the last one stays.
  if (!(closest.distance > 1e-3 * core_->radius)) return;
  const Vec3 away = (closest.on_segment - closest.on_triangle.point) / closest.distance;
  const Vec3 last = pose.rotation * contact.normal_P;
  // A core driven through the wall still belongs to the side it came from.
  const Vec3 normal = away.dot(last) >= 0 ? away : -away;
  contact.barycentric = closest.on_triangle.weights;
  contact.normal_P = pose.rotation.conjugate() * normal;
  contact.point_P = pose.to_body(closest.on_segment - core_->radius * normal);
}

void ProbeContacts::append_rows(std::uint32_t organ, const Body& body, const OrganState& state,
                                double h, double fraction, std::vector<ContactRow>& rows) {
  const Pose before = pose_at(fraction - h / period_), after = pose_at(fraction);
  const std::size_t first = rows.size();
  for (CarriedContact& contact : contacts_) {
    if (contact.organ != organ) continue;
    if (core_) measure_again(body, state, before, contact);
    ContactRow row;
    row.nodes = body.triangles[contact.triangle];
    row.weights = contact.barycentric;
    row.normal = after.rotation * contact.normal_P;
    Vec3 tissue = Vec3::Zero();
    for (int k = 0; k < 3; ++k) tissue += row.weights[k] * state.positions[row.nodes[k]];
    const Vec3 point = before.to_world(contact.point_P);
    row.gap = row.normal.dot(point - tissue);
    row.probe_velocity = (after.to_world(contact.point_P) - point) / h;
    row.friction = friction_;
    row.normal_impulse = contact.normal_impulse;
    row.tangential_impulse = contact.tangential_impulse;
    rows.push_back(row);
  }
  if (!gentle_.empty() || !begun_.empty()) {
    be_gentle(organ, state, h, std::span(rows).subspan(first));
  }
}

std::size_t ProbeContacts::take_rows(std::uint32_t organ, const ContactRow* rows) {
  std::size_t taken = 0;
  for (CarriedContact& contact : contacts_) {
    if (contact.organ != organ) continue;
    const ContactRow& row = rows[taken++];
    contact.normal_impulse = row.normal_impulse;
    contact.tangential_impulse = row.tangential_impulse;
    if (row.normal_impulse <= 0) continue;
    contact.pushed += row.normal_impulse * row.normal;
    contact.dragged -= row.tangential_impulse;
  }
  return taken;
}

Vec3 ProbeContacts::impulse() const {
  Vec3 sum = Vec3::Zero();
  for (const CarriedContact& contact : contacts_) sum += contact.pushed + contact.dragged;
  return sum;
}

bool ProbeContacts::touches(std::uint32_t organ) const {
  return std::any_of(contacts_.begin(), contacts_.end(), [&](const CarriedContact& contact) {
    return contact.organ == organ && contact.normal_impulse > 0;
  });
}

}  // namespace palpate::deformation
