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
};

/// Nodes of one organ that one plane of the probe touches, or may within this step. What a contact
/// of each of them would say follows from the plane and from where the node is: contact_on_face().
struct FaceContacts {
  std::uint32_t organ = 0;        ///< index in the scene's list
  Vec3 point_P = Vec3::Zero();    ///< of the plane, in P [m]
  Vec3 normal_P = Vec3::UnitZ();  ///< unit, from tissue to probe, in P
  double gap = 0;                 ///< of the deepest node [m]
  std::uint32_t node_count = 0;   ///< ≥ 1; its nodes follow those of the face before it
};

/// Contacts of one probe. Gaps and weights hold for the probe at `probe_pose`.
struct ContactSet {
  std::uint32_t probe = 0;  ///< index in the scene's list
  Pose probe_pose;          ///< X_WP
  /// Some were left out that the answer needs; the deepest are kept.
  bool truncated = false;
  std::vector<FaceContacts> faces;        ///< sorted by organ
  std::vector<std::uint32_t> face_nodes;  ///< of the organ's surface, face by face
  std::vector<Contact> contacts;          ///< all others, sorted by (organ, triangle)

  bool empty() const { return faces.empty() && contacts.empty(); }
  std::size_t count() const { return face_nodes.size() + contacts.size(); }  ///< places in all
  double deepest_gap() const;  ///< least of all; infinity if there are none [m]
  void clear();                ///< no contacts, nothing left out
};

/// Of a node of a face: its contact but for `triangle` and `barycentric`.
/// @param tissue_P  where the node is, in P [m]
Contact contact_on_face(const FaceContacts& face, const Vec3& tissue_P);

/// The most rows of a local law.
inline constexpr std::size_t kMaxLawRows = 16;

/// One place where the tissue touches a probe, or will when it comes nearer.
struct LawRow {
  Vec3 point_P = Vec3::Zero();   ///< of the probe's surface, in P [m]
  Vec3 normal = Vec3::UnitZ();   ///< n, unit, from tissue to probe
  double gap = 0;                ///< along n at the anchor, ≥ 0; 0 where it presses [m]
  double radius = 0;             ///< of a round probe, whose n turns as it moves; 0: flat [m]
  Vec3 force = Vec3::Zero();     ///< on the probe at the anchor [N]; along n ≥ 0
  Vec3 velocity = Vec3::Zero();  ///< of the tissue there while its forces stay [m/s]
};

/// The tissue's force on a probe near the pose for which deformation computed it: the touched patch
/// condensed to its contact rows. With the rows' forces λ and those at the anchor λ⁰, the probe
/// displaced by Δx at a row, t since the anchor,
///   s = gap n + Δx − velocity t + W (λ − (1 + growth (t + period/2)) λ⁰)
///   0 ≤ λ·n ⊥ s·n ≥ 0,   friction in Coulomb's cone.
/// W is the tissue's compliance over one period of deformation: what the rows give way by at its
/// end when the forces act for all of it. A tissue that goes on at its velocity meets forces that
/// go on growing (λ⁰ is the mean of the last period): without them the law would be stiff against
/// its mass and late against its elasticity. After J. Saupin, C. Duriez, S. Cotin, "Contact model
/// for haptic medical simulations", ISBMS 2008, where the tissue stands still between two laws.
struct LocalLaw {
  Pose anchor;            ///< X_WP at which the rows hold
  double anchor_age = 0;  ///< how old that pose was when the law was made, ≥ 0 [s]
  double period = 0;      ///< of deformation, ≥ 0; the tissue's velocity is good for two [s]
  double growth = 0;      ///< of the rows' forces while the tissue goes on [1/s]
  double friction_coefficient = 0;  ///< ≥ 0
  double validity_radius = 0;       ///< Δx of the probe's origin up to which the rows hold [m]
  std::vector<LawRow> rows;         ///< at most kMaxLawRows
  /// W, symmetric, its lower triangle row by row [m/N]: along the normals without friction, else
  /// along n, t, s of each row (contact_basis()).
  std::vector<double> compliance;
  /// −∂f/∂x at the anchor with the rows that press, those that stick too; symmetric [N/m]
  Mat3 stiffness = Mat3::Zero();

  bool touching() const;  ///< some row presses
  Vec3 force() const;     ///< of all rows at the anchor [N]
  Vec3 torque() const;    ///< about the probe's origin [N·m]
  std::size_t directions() const { return friction_coefficient > 0 ? 3 : 1; }  ///< of a row in W
};

/// n and two tangents, each a column; from the normal alone.
Mat3 contact_basis(const Vec3& normal);
/// The same after the shortest rotation that turns its n into `normal`, unit.
Mat3 turned_basis(const Mat3& basis, const Vec3& normal);

/// Why the rendered force differs from the law's. Bits.
enum ForceLimit : std::uint32_t {
  kForceNotLimited = 0,
  kForceSaturated = 1u << 0,      ///< magnitude clamped to the scene's max_force_n
  kForceSlewLimited = 1u << 1,    ///< change per tick clamped
  kForceStaleFade = 1u << 2,      ///< local law too old: fading to zero
  kForcePassivity = 1u << 3,      ///< passivity controller dissipates
  kForceNotFinite = 1u << 4,      ///< law or device gave NaN/Inf: treated as zero
  kForceOutOfValidity = 1u << 5,  ///< probe outside the law's validity radius
  kPoseSlewed = 1u << 6,          ///< the driver moved too fast: the probe is on its way to it
  kPoseRefused = 1u << 7,         ///< a driver's sample was no pose, or older than the one before
  kDriverSilent = 1u << 8,        ///< a driver is not heard of, or again: the force fades, or rises
  kStiffnessCapped = 1u << 9,     ///< law stiffer than the device can hold: felt through a spring
  kAllForceLimits = (1u << 10) - 1
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
