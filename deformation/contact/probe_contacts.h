// The contacts of one probe, carried along with it through the sub-steps of an advance.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "deformation/contact/contact_solve.h"
#include "deformation/model/organ_state.h"
#include "modules/core/touch.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

/// A contact between two messages from collision. Flat probe surfaces stay the planes they are and
/// move with the probe. Round ones (RoundedSegment) are measured anew in every sub-step against
/// their core: a plane frozen for a period would tilt late as the tissue slides under a fingertip,
/// which feeds energy into the sideways swing of the patch.
struct CarriedContact : Contact {
  double normal_impulse = 0;               ///< of the last sub-step, for its next start [N·s]
  Vec3 tangential_impulse = Vec3::Zero();  ///< likewise
  // On the probe over the advance, in W [N·s]:
  Vec3 pushed = Vec3::Zero();   ///< along the normals
  Vec3 dragged = Vec3::Zero();  ///< by friction
};

class ProbeContacts {
 public:
  static constexpr double kSeenDepth = 1e-3;    ///< [m]
  static constexpr double kGentleRise = 0.03;   ///< to the speed of a gentle push [s]
  static constexpr double kGentleEnd = 0.2;     ///< its speed falls with the depth over this [s]
  static constexpr double kGentleDepth = 5e-6;  ///< at which it is over [m],
  static constexpr double kGentleTime = 2;      ///< or, under a hand that moves, after this [s]

  explicit ProbeContacts(const scene::Probe& probe);

  void reset();
  void set_pose(const Pose& pose);
  /// Replaces the contacts; a contact on a triangle that had one starts from its impulses. Where
  /// the probe had no contact with an organ and now has one deeper than kSeenDepth and its own way,
  /// it was not seen coming: until it is out, it is pushed at no more than kGentleSpeed.
  void set_contacts(std::span<const Contact> contacts);

  /// Begins an advance of `period` [s], in which the probe moves from where it was to the newest
  /// pose. @returns false if it jumped: its contacts are dropped
  bool begin(double period);
  void end() { start_ = target_; }  ///< ends it

  /// Appends the rows of this probe's contacts with `organ` at `fraction` (0, 1] of the advance.
  /// A row at the sub-step's start is given by the probe at its end, minus the way it moves.
  void append_rows(std::uint32_t organ, const Body& body, const OrganState& state, double h,
                   double fraction, std::vector<ContactRow>& rows);
  /// Takes the solved rows back, in the order they were appended. @returns their number
  std::size_t take_rows(std::uint32_t organ, const ContactRow* rows);

  bool touches(std::uint32_t organ) const;
  double friction() const { return friction_; }
  double radius() const { return core_ ? core_->radius : 0; }  ///< of a round probe, else 0 [m]
  const Pose& pose() const { return target_; }                 ///< at the end of the advance
  Vec3 impulse() const;  ///< on the probe over the advance [N·s]
  const std::vector<CarriedContact>& contacts() const { return contacts_; }

 private:
  Pose pose_at(double fraction) const;
  /// Weights, point and normal of a round probe's contact for tissue and probe as they are.
  void measure_again(const Body& body, const OrganState& state, const Pose& pose,
                     CarriedContact& contact) const;
  /// Of the probe's origin in this advance [m].
  double way() const { return (target_.position - start_.position).norm(); }
  void note_begun();
  void be_gentle(std::uint32_t organ, const OrganState& state, double h,
                 std::span<ContactRow> rows);

  double friction_;
  std::optional<geometry::RoundedSegment> core_;
  bool placed_ = false;
  Pose start_, target_;
  double period_ = 0;
  std::vector<CarriedContact> contacts_, previous_contacts_;
  struct GentleOrgan {
    std::uint32_t organ = 0;
    double time = 0;  ///< since the first contact [s]
  };
  std::vector<GentleOrgan> gentle_;
  std::vector<std::uint32_t> begun_;  ///< organs first touched by the newest contacts
};

}  // namespace palpate::deformation
