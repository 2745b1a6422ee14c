// What the physics libraries hand each other about a touch: contacts, the tissue's local law, the
// rendered force. SI units, frame W unless said. A contact lives in the frame P of its probe from
// the search to the solver; a name says so by its end.
//
// Sign conventions: a contact normal points from tissue to probe; a gap is positive when apart; a
// force acts on the probe, the tissue receives its negative.
#pragma once

#include <cstdint>
#include <vector>

#include "modules/core/types.h"

namespace palpate {

/// One place where a probe touches, or within this step may touch, an organ.
struct Contact {
  std::uint32_t organ = 0;          ///< index in the scene's list
  std::uint32_t triangle = 0;       ///< index in the organ's surface
  Vec3 barycentric = Vec3::Zero();  ///< weights of the triangle's nodes, ≥ 0, sum 1
  Vec3 point_P = Vec3::Zero();      ///< nearest point of the probe's surface, in P [m]
  Vec3 normal_P = Vec3::UnitZ();    ///< unit, from tissue to probe, in P
  double gap = 0;                   ///< along the normal; negative = penetration [m]
  double time_of_impact = 1;  ///< fraction of the swept step at first touch, 1 = no touch within
};

/// Contacts of one probe. Gaps and weights hold for the probe at `probe_pose`.
struct ContactSet {
  std::uint32_t probe = 0;        ///< index in the scene's list
  Pose probe_pose;                ///< X_WP
  bool truncated = false;         ///< there were more; the deepest are kept
  std::vector<Contact> contacts;  ///< sorted by (organ, triangle)
};

/// How the tissue's force on a probe varies near `anchor`:
/// f(x) = force + stiffness · (anchor − x), its normal part ≥ 0, its tangential part within the
/// friction cone. Not valid further than `validity_radius` from the anchor. The literature calls
/// such a law an intermediate representation (Adachi 1995; Mark et al. 1996).
struct LocalLaw {
  bool touching = false;          ///< false: the tissue gives no force near the anchor
  Vec3 anchor = Vec3::Zero();     ///< probe origin at which `force` was computed [m]
  Vec3 force = Vec3::Zero();      ///< on the probe [N]
  Vec3 torque = Vec3::Zero();     ///< on the probe about its origin [N·m]
  Mat3 stiffness = Mat3::Zero();  ///< −∂force/∂x, symmetric, positive semidefinite [N/m]
  Vec3 normal = Vec3::UnitZ();    ///< unit, from tissue to probe
  double friction_coefficient = 0;
  double validity_radius = 0;  ///< [m]
};

/// Why the rendered force differs from the law's. Bits.
enum ForceLimit : std::uint32_t {
  kForceNotLimited = 0,
  kForceSaturated = 1u << 0,     ///< magnitude clamped to the scene's max_force_n
  kForceSlewLimited = 1u << 1,   ///< change per tick clamped
  kForceStaleFade = 1u << 2,     ///< local law too old: fading to zero
  kForcePassivity = 1u << 3,     ///< passivity controller dissipates
  kForceNotFinite = 1u << 4,     ///< law or device gave NaN/Inf: treated as zero
  kForceOutOfValidity = 1u << 5  ///< probe outside the law's validity radius
};

/// Force commanded to a device at one haptic tick.
struct RenderedForce {
  Vec3 force = Vec3::Zero();                ///< on the probe [N]
  Vec3 torque = Vec3::Zero();               ///< on the probe about its origin [N·m]
  std::uint32_t limits = kForceNotLimited;  ///< ForceLimit bits
  double passivity_energy = 0;   ///< energy observed at the probe port, negative = generated [J]
  double contact_model_age = 0;  ///< of the law at the tick; infinity before the first [s]
};

}  // namespace palpate
