// Organs touching each other and themselves: finds the pairs of features that are near, solves
// their contacts when all organs have made the same step, and lets nothing pass through anything
// (docs/decisions/0012-organ-contact.md).
#pragma once

#include <span>
#include <vector>

#include "collision/near_features.h"
#include "deformation/contact/organ_contact_rows.h"
#include "deformation/guard/advance_report.h"
#include "deformation/simulated_organ.h"
#include "modules/core/state_archive.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

class OrganContacts {
 public:
  /// Touching surfaces rest this far apart, so that the direction between them has a meaning; those
  /// of one organ that are nearer at rest, at half of that [m].
  static constexpr double kRestGap = 2e-4;
  /// Organs whose rest shapes are nearer than this have no side to be on [m].
  static constexpr double kLeastRestDistance = 1e-5;

  /// @param organs  at rest; outlive this
  /// @throws InputError naming the organs if they cross or touch at rest, or the key of a model or
  ///                    integrator that knows no such contacts
  OrganContacts(const scene::Scene& scene, std::vector<SimulatedOrgan*> organs);

  /// Before the organs make a step.
  void begin_step();
  /// After all organs have made a step of h [s].
  /// @param probe_rows  by organ, as solved in its step; get the impulses that hold beside organs
  void end_step(double h, std::span<const std::span<ContactRow>> probe_rows, AdvanceReport& report);

  /// Contacts that press on an organ since the last step, each with itself once.
  std::size_t count(std::size_t organ) const;

  /// Whether surfaces pass through each other that may not. They can only after a state was
  /// replaced from outside.
  bool are_crossed();
  /// Forgets impulses and pairs: the organs are elsewhere.
  void reset();

  /// Between two advances.
  void exchange(StateArchive& archive);

 private:
  struct Remembered {
    ContactKey key{};
    double normal_impulse = 0;
    Vec3 tangential_impulse = Vec3::Zero();
    void exchange(StateArchive& archive) { archive(key, normal_impulse, tangential_impulse); }
  };

  void refuse_crossed_rest(const scene::Scene& scene);
  void search(double reach);
  bool measure_travel(double spare);
  void collect_pairs();
  void make_rows(double h);
  void append_probe_rows(double h);
  double rest_gap(const StepPair& step) const;
  void start_from_last();
  OrganContactReport solve(double h);
  /// @param step  how far the farthest node goes in it, beside what all do [m]
  Confinement try_step(double h, double step, double spare, OrganContactReport& solved);
  void remember();
  void hand_over(double h);
  void append_halves(std::uint32_t organ);

  double friction_ = 0;
  std::vector<SimulatedOrgan*> organs_;
  collision::NearFeatures features_;
  double reach_ = 0;              ///< of the last search [m]; 0: there was none
  double least_reach_ = 0;        ///< [m]
  std::vector<Remembered> last_;  ///< impulses of the last step, sorted by key
  // Of one step:
  std::vector<std::vector<Vec3>> start_, asked_, end_;  ///< by organ [m]
  Vec3 together_ = Vec3::Zero();  ///< how far all have come since the last search [m]
  std::vector<double> travel_;    ///< by organ, beside that [m]
  std::vector<StepPair> pairs_;
  std::span<const std::span<ContactRow>> probe_rows_;
  std::vector<OrganContactRow> rows_;  ///< of organs, then of probes
  std::size_t organ_rows_ = 0;
  std::vector<TouchedOrgan> touched_;
  std::vector<VolumeGradient> volumes_;
  std::vector<ContactRow> halves_;  ///< of rows, on one organ
};

}  // namespace palpate::deformation
