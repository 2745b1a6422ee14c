#include "deformation/contact/probe_contacts.h"

#include <algorithm>

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
  response_.reset();
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
}

bool ProbeContacts::begin(double period) {
  period_ = period;
  response_.begin(period);
  if ((target_.position - start_.position).norm() <= kMaxProbeSpeed * period) return true;
  start_ = target_;
  contacts_.clear();
  return false;
}

void ProbeContacts::end(double stiffness_limit) {
  start_ = target_;
  response_.end(target_.position, stiffness_limit);
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
}

std::size_t ProbeContacts::take_rows(std::uint32_t organ, double fraction, const ContactRow* rows) {
  const Pose after = pose_at(fraction);
  std::size_t taken = 0;
  for (CarriedContact& contact : contacts_) {
    if (contact.organ != organ) continue;
    const ContactRow& row = rows[taken++];
    contact.normal_impulse = row.normal_impulse;
    contact.tangential_impulse = row.tangential_impulse;
    if (row.normal_impulse <= 0) continue;
    response_.add(row.normal_impulse * row.normal - row.tangential_impulse, row.normal,
                  after.to_world(contact.point_P), after.position);
  }
  return taken;
}

bool ProbeContacts::touches(std::uint32_t organ) const {
  return std::any_of(contacts_.begin(), contacts_.end(), [&](const CarriedContact& contact) {
    return contact.organ == organ && contact.normal_impulse > 0;
  });
}

}  // namespace palpate::deformation
