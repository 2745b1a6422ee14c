// The contacts of one probe, carried along with it through the sub-steps of an advance.
#pragma once

#include <vector>

#include "deformation/contact_response.h"
#include "deformation/contact_solve.h"
#include "modules/core/messages.h"

namespace palpate::deformation {

/// Faster than any hand or surgical tool [m/s]: a probe that seems to move faster has jumped.
inline constexpr double kMaxProbeSpeed = 3.0;

/// A contact in the probe's frame, where it stays fixed until the next contacts arrive.
struct CarriedContact {
  std::uint32_t organ = 0;
  std::uint32_t triangle = 0;
  Vec3 weights = Vec3::Zero();
  Vec3 point_P = Vec3::Zero(), normal_P = Vec3::UnitZ();
  double normal_impulse = 0;               ///< of the last sub-step, for its next start [N·s]
  Vec3 tangential_impulse = Vec3::Zero();  ///< likewise
};

class ProbeContacts {
 public:
  explicit ProbeContacts(double friction) : friction_(friction) {}

  void reset();
  void set_pose(const Pose& pose);
  /// Replaces the contacts; a contact on a triangle that had one starts from its impulses.
  void set_contacts(const Contacts& contacts);

  /// Begins an advance of `period` [s], in which the probe moves from where it was to the newest
  /// pose. @returns false if it jumped: its contacts are dropped
  bool begin(double period);
  /// Ends it.
  void end(double stiffness_limit);

  /// Appends the rows of this probe's contacts with `organ` at `fraction` (0, 1] of the advance.
  /// A row at the sub-step's start is given by the probe at its end, minus the way it moves.
  void append_rows(std::uint32_t organ, const OrganModel& model, const OrganState& state, double h,
                   double fraction, std::vector<ContactRow>& rows);
  /// Takes the solved rows back, in the order they were appended. @returns their number
  std::size_t take_rows(std::uint32_t organ, double fraction, const ContactRow* rows);

  bool touches(std::uint32_t organ) const;
  double friction() const { return friction_; }
  const ContactResponse& response() const { return response_; }
  const std::vector<CarriedContact>& contacts() const { return contacts_; }

 private:
  Pose pose_at(double fraction) const;

  double friction_;
  bool placed_ = false;
  Pose start_, target_;
  double period_ = 0;
  std::vector<CarriedContact> contacts_, previous_contacts_;
  ContactResponse response_;
};

}  // namespace palpate::deformation
