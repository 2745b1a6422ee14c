// One organ with all that keeps it alive: its dynamics, the volume it is asked for, and what is
// done when its state is implausible (divergence_detector.h).
//
// From mild to harsh, each seen in AdvanceReport:
//   1. suspicious energy: the next steps are halved, quartered, … down to 1/2^kMostHalvings
//   2. implausible: back to the last good state, at rest, with halved steps; where that is inside
//      a probe, contacts push it out at kGentleSpeed for kQuietTime
//   3. implausible for the fourth time: back to the rest state, and no contacts for kQuietTime
// kQuietTime without any of them doubles the steps again and forgives a failure. Each advance ends
// in a state that was checked; none is computed twice.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "deformation/contact/starting_impulses.h"
#include "deformation/guard/advance_report.h"
#include "deformation/guard/divergence_detector.h"
#include "deformation/model/organ_model.h"
#include "deformation/model/target_volume.h"
#include "deformation/steppers/organ_dynamics.h"
#include "modules/core/state_archive.h"

namespace palpate::deformation {

/// Least cap of the pressure |p| of a volume constraint [Pa]: an atmosphere, five times what a
/// cough makes. Stiff walls hold more: the cap is kPressureCapOfWall E t/R if that is larger. A
/// step that would need more is taken with the cap instead of the constraint.
inline constexpr double kLeastPressureCap = 1e5;
inline constexpr double kPressureCapOfWall = 10;
/// A volume further from V* than this part of V₀ is not corrected at once: V* begins again at the
/// volume there is and goes back no faster than the scene's max_rate_per_s.
inline constexpr double kMaxVolumeError = 0.05;
/// An organ that nothing touches and whose volume cannot be corrected, or a solid that is folded,
/// for longer than this does not come back by itself [s].
inline constexpr double kCollapsedTime = 0.5;
inline constexpr int kMostHalvings = 3;
inline constexpr int kMostFailures = 3;
inline constexpr int kMostRevisions = 4;
inline constexpr double kQuietTime = 1.0;  ///< simulated [s]
/// Energy, volume and inversion are checked in every such advance, and after any guard acted.
inline constexpr int kThoroughCheckEvery = 16;

/// Off: nothing of the above is done. For measuring what it is worth (`palpate fuzz`).
enum class Guarding : std::uint8_t { kOn, kOff };

class SimulatedOrgan {
 public:
  /// @param runner  outlives this; none: the calling thread alone
  SimulatedOrgan(const scene::Organ& organ, std::unique_ptr<const OrganModel> model,
                 std::unique_ptr<OrganDynamics> dynamics, Guarding guarding = Guarding::kOn,
                 ChunkRunner* runner = nullptr);

  const OrganModel& model() const { return *model_; }
  OrganDynamics& dynamics() const { return *dynamics_; }
  const OrganState& state() const { return state_; }

  double volume() const;  ///< that its surface encloses [m³]

  int substeps(double period) const;
  bool contacts_suspended() const { return suspension_time_ > 0; }  ///< takes no contacts for now

  /// Starts from any state. V* begins at its volume.
  void put(const OrganState& state);
  void reset();                                                     ///< at rest, at time 0
  void ask_for_volume(double ratio) { target_volume_.ask(ratio); }  ///< target_volume.h

  using Carry = std::function<OrganState(const OrganState&)>;
  /// Goes on as the same organ on another mesh; guards do, too.
  /// @param carry  a state from the model it has to `model`
  /// @param seat   moves the state it goes on from, there
  void change_mesh(std::unique_ptr<const OrganModel> model, std::unique_ptr<OrganDynamics> dynamics,
                   const Carry& carry, const std::function<void(OrganState&)>& seat);

  /// Moves its nodes where a step left them wrong.
  void move_nodes(const std::function<void(std::span<Vec3>)>& move) { move(state_.positions); }

  /// One step of h [s] that ends at simulated `time` [s].
  void step(double time, double h, std::span<ContactRow> rows, AdvanceReport& report);
  /// The same; it is taken again from its start, with the rows there are then and the impulses
  /// they started from, while `revise`, given the states at its start and end, finds that they
  /// missed something, at most kMostRevisions times. None: once.
  /// @param last_resort  whether it is taken even if that is a crossing then
  /// @returns false if it was not: the organ is as before
  using Revise = std::function<Missed(const OrganState& start, const OrganState& end)>;
  bool step(double time, double h, std::vector<ContactRow>& rows, const Revise& revise,
            bool last_resort, AdvanceReport& report);

  /// What steps can be taken back to, within an advance.
  struct Mark {
    OrganState state;
    TargetVolume target_volume{scene::Filling()};
    DivergenceDetector::Ledger energy;
    double collapsed_time = 0;
    int advances = 0;
  };
  void keep(Mark& mark) const;
  void go_back(const Mark& mark);

  /// Changes the end of the last step, of h [s], as if contacts with organs had been in it: the
  /// velocities with the surface's way.
  /// @param surface         where its nodes come to [m]  (surface_node_count)
  /// @param volume_impulse  of the contents, to keep the volume meanwhile [Pa·s]
  /// @param rows            each other surface as a probe
  void correct_step(double h, std::span<const Vec3> surface, double volume_impulse,
                    std::span<const ContactRow> rows);

  /// Ends an advance of `period` [s]. @returns false if the state was replaced: impulses of the
  /// rows of this advance mean nothing
  bool finish(double period, AdvanceReport& report);

  /// Between two advances, of the same mesh.
  void exchange(StateArchive& archive);

 private:
  /// @returns V* before it
  double begin_step(double time, double h, std::span<ContactRow> rows);
  /// Of what the guards put back, for a while.
  void push_gently(double h, std::span<ContactRow> rows) const;
  double missed_volume(double asked, const StepReport& stepped) const;
  void end_step(double h, std::span<const ContactRow> rows, double target_before,
                const StepReport& stepped, AdvanceReport& report);
  void release_volume();
  bool volume_is_far() const;
  bool has_rest_volume() const;
  void recover(Violation reason, AdvanceReport& report);
  void shorten_steps();
  void lengthen_steps(double period);

  std::unique_ptr<const OrganModel> model_;
  std::unique_ptr<OrganDynamics> dynamics_;
  TargetVolume target_volume_;
  bool knows_energy_;
  ChunkRunner* runner_;
  std::unique_ptr<DivergenceDetector> detector_;
  OrganState state_, last_good_;
  OrganState start_;  ///< of a step that may be taken again
  StartingImpulses started_;
  Guarding guarding_;
  bool holds_volume_ = false;   ///< by a constraint that answers an error with an impulse
  double pressure_limit_ = 0;   ///< [Pa]; infinite where no constraint makes it
  int halvings_ = 0;            ///< of the step
  int failures_ = 0;            ///< implausible states, less those forgiven
  double suspension_time_ = 0;  ///< left [s]
  double gentle_time_ = 0;      ///< left [s]
  double quiet_time_ = 0;       ///< since a guard acted [s]
  /// At the last thorough check a solid had tetrahedra inside out and a volume far from V₀.
  bool folded_ = false;
  double collapsed_time_ = 0;  ///< [s]
  int advances_ = 0;           ///< since the last thorough check
};

}  // namespace palpate::deformation
