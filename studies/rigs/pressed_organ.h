// One organ and its probes as a session in one process, the probes moved from outside, period by
// period, and the processor time of its modules taken.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "haptics/devices/placed_device.h"
#include "palpate/session/in_process.h"

namespace palpate::rigs {

class PressedOrgan {
 public:
  /// @param scene  one organ; the probes' devices are not looked at, and every module's rate is
  ///               that of deformation
  /// @param poses  of the probes at the start
  /// @throws InputError as DeformationWorld, or if a probe's mesh cannot be loaded
  PressedOrgan(const scene::Scene& scene, const geometry::OrganShape& shape,
               std::vector<Pose> poses);
  PressedOrgan(const PressedOrgan&) = delete;
  PressedOrgan& operator=(const PressedOrgan&) = delete;

  /// One period, in which the probes move to `poses`.
  void advance(const std::vector<Pose>& poses);

  /// All probes move in straight lines, the one with the longest way at `speed` [m/s], then settle
  /// for at most 3 s.
  /// @param to          positions of the probes [m]
  /// @param keep_going  asked before each period; may throw
  void move_and_settle(const std::vector<Vec3>& to, double speed,
                       const std::function<void()>& keep_going);

  /// The probes stay until, over 0.1 s, no force changed by more than 2e-4 of it and the kinetic
  /// energy is below 1e-6 of the elastic energy; at most `longest` [s].
  /// @param keep_going  asked before each period; may throw
  void settle(double longest, const std::function<void()>& keep_going);

  double period() const { return period_; }
  const Pose& pose(std::size_t probe) const { return poses_[probe]; }
  Vec3 force(std::uint32_t probe) const;  ///< on the probe in the last period [N]
  /// See DeformationWorld.
  double estimated_force_error(std::uint32_t probe) const {
    return session_.world().estimated_force_error(probe);
  }
  LocalLaw law(std::uint32_t probe) const { return session_.world().local_law(probe); }
  // As deformation computes them: the wire's float32 is for others.
  Vec3 position(std::size_t node) const;       ///< now [m]
  Vec3 rest_position(std::size_t node) const;  ///< [m]
  std::size_t node_count() const { return model().node_count(); }
  const deformation::OrganModel& model() const { return session_.world().model(0); }
  /// Of its mesh: counts its changes.
  std::uint32_t generation() const { return session_.world().generation(0); }
  std::uint32_t changes() const { return generation() - first_generation_; }
  geometry::TriangleSurface skin() const;  ///< at rest, as it is meshed now
  /// See DeformationWorld.
  std::span<const deformation::TouchedPlace> touched_places() const {
    return session_.world().touched_places(0);
  }
  deformation::OrganReading read() const { return session_.world().read(0); }
  double elastic_energy() const { return session_.world().elastic_energy(0); }  ///< [J]
  /// Of the last period.
  const deformation::AdvanceReport& report() const { return session_.deformation().report(); }
  double step() const { return period_ / session_.world().substeps(0, period_); }  ///< h [s]

  double volume_error() const { return volume_error_; }  ///< largest |V − V*|/V* so far
  bool diverged() const { return diverged_; }            ///< the world had to put the organ back
  /// Contacts were left out or lost: what was measured is not of this press.
  bool lacks_contacts() const { return contact_troubles().truncated + contact_troubles().lost > 0; }
  ContactTroubles contact_troubles() const { return session_.contact_troubles(); }
  double busy() const { return busy_; }            ///< processor time in deformation so far [s]
  double searching() const { return searching_; }  ///< the same in collision [s]
  double rendering() const { return rendering_; }  ///< the same in haptics [s]
  /// Processor time in which all that is said in a period becomes bytes; nothing is sent [s].
  double encoding() const;
  /// The same of its mesh, which is said once, and anew when it changes [s].
  double encoding_of_mesh() const;
  double time() const { return session_.world().time(); }  ///< simulated so far [s]

 private:
  session::InProcessOptions timed();
  void place_probes();

  double period_, busy_ = 0, searching_ = 0, rendering_ = 0, volume_error_ = 0;
  bool diverged_ = false;
  std::vector<Pose> poses_;
  session::InProcess session_;
  std::uint32_t first_generation_ = 0;
  std::vector<haptics::PlacedDevice*> devices_;  ///< the session's
};

}  // namespace palpate::rigs
