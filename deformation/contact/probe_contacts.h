// The contacts of one probe, carried along with it through the sub-steps of an advance.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "deformation/contact/contact_response.h"
#include "deformation/contact/contact_solve.h"
#include "deformation/model/organ_state.h"
#include "modules/core/touch.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

/// Faster than any hand or surgical tool [m/s]: a probe that seems to move faster has jumped.
inline constexpr double kMaxProbeSpeed = 3.0;

/// A contact between two messages from collision. Flat probe surfaces stay the planes they are and
/// move with the probe. Round ones (RoundedSegment) are measured anew in every sub-step against
/// their core: a plane frozen for a period would tilt late as the tissue slides under a fingertip,
/// which feeds energy into the sideways swing of the patch.
struct CarriedContact : Contact {
  double normal_impulse = 0;               ///< of the last sub-step, for its next start [N·s]
  Vec3 tangential_impulse = Vec3::Zero();  ///< likewise
};

class ProbeContacts {
 public:
  explicit ProbeContacts(const scene::Probe& probe);

  void reset();
  void set_pose(const Pose& pose);
  /// Replaces the contacts; a contact on a triangle that had one starts from its impulses.
  void set_contacts(std::span<const Contact> contacts);

  /// Begins an advance of `period` [s], in which the probe moves from where it was to the newest
  /// pose. @returns false if it jumped: its contacts are dropped
  bool begin(double period);
  /// Ends it.
  void end(double stiffness_limit);

  /// Appends the rows of this probe's contacts with `organ` at `fraction` (0, 1] of the advance.
  /// A row at the sub-step's start is given by the probe at its end, minus the way it moves.
  void append_rows(std::uint32_t organ, const Body& body, const OrganState& state, double h,
                   double fraction, std::vector<ContactRow>& rows);
  /// Takes the solved rows back, in the order they were appended. @returns their number
  std::size_t take_rows(std::uint32_t organ, double fraction, const ContactRow* rows);

  bool touches(std::uint32_t organ) const;
  double friction() const { return friction_; }
  const ContactResponse& response() const { return response_; }
  const std::vector<CarriedContact>& contacts() const { return contacts_; }

 private:
  Pose pose_at(double fraction) const;
  /// Weights, point and normal of a round probe's contact for tissue and probe as they are.
  void measure_again(const Body& body, const OrganState& state, const Pose& pose,
                     CarriedContact& contact) const;

  double friction_;
  std::optional<geometry::RoundedSegment> core_;
  bool placed_ = false;
  Pose start_, target_;
  double period_ = 0;
  std::vector<CarriedContact> contacts_, previous_contacts_;
  ContactResponse response_;
};

}  // namespace palpate::deformation
