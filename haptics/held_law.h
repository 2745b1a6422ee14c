// The law of one source, from its arrival to its end: taken over by the next one gradually, faded
// when it is old. What a probe feels is the sum of those of all sources: each process of
// deformation tells the law of its own organs, at its own times.
#pragma once

#include <cstdint>

#include "haptics/local_law.h"
#include "haptics/wrench.h"
#include "modules/core/touch.h"
#include "modules/core/touch_state.h"
#include "modules/scene/scene.h"

namespace palpate::haptics {

class HeldLaw {
 public:
  /// A new law's difference to the one before is spread over its period, at most over this [s].
  static constexpr double kLongestCrossFade = 0.025;
  /// A probe that is near nothing, by its law, is let go within this, debt or not [s].
  static constexpr double kLetGo = 0.025;

  HeldLaw(const scene::Haptics& limits, double period);  ///< period of the loop [s]

  /// Made at session time `time` [s]; takes over at the next tick.
  /// @param law  is_usable()
  void receive(const LocalLaw& law, double time);
  void clear();

  bool has_next() const { return next_.valid; }
  const LocalLaw& next() const { return next_.law; }
  /// Zero where it is not felt [N/m].
  Mat3 felt_stiffness() const { return felt_ ? current_.law.stiffness : Mat3::Zero(); }
  /// The next law takes over. Both are compared at the same place, so that only their difference is
  /// smoothed and never the probe's motion.
  /// @param softening  as LawSolver::take(); below 0: as it was
  void take_next(const Pose& pose, double time, double softening);

  /// Once a tick.
  void pass_tick() {
    if (cross_fade_left_ > 0) --cross_fade_left_;
  }
  /// The law with what is left of the cross-fade, faded by age. @param limits  get the bits that
  /// act
  Wrench wrench_at(const Pose& pose, double time, std::uint32_t& limits);
  double stored_energy() const { return felt_ ? solver_.stored_energy() : 0; }  ///< [J]
  /// What of the last force is normal to the tissue, without cross-fade and fade [N].
  const Vec3& pressing() const { return pressing_; }
  /// The last wrench without what age took of it.
  const Wrench& unfaded() const { return unfaded_; }

  double age(double time) const { return age(current_, time); }  ///< infinity before the first [s]
  double newest_age(double time) const { return age(next_.valid ? next_ : current_, time); }
  /// Too old to be felt, or of a probe in the open for a while.
  bool tells_nothing(double time) const;

  void exchange(StateArchive& archive) {
    archive(current_, next_, without_rows_, solver_, felt_, pressing_, unfaded_, softening_,
            cross_fade_ticks_, cross_fade_left_, cross_fade_);
  }

 private:
  struct Received {
    LocalLaw law;
    double time = 0;     ///< of reception [s]
    bool valid = false;  ///< there is one
    void exchange(StateArchive& archive) { archive(law, time, valid); }
  };
  static double age(const Received& received, double time);

  double stale_after_, fade_time_, period_;
  Received current_, next_;  ///< `next_` takes over at the coming tick
  double without_rows_ = 0;  ///< since when laws have none, if the current one has none [s]
  LawSolver solver_;         ///< of the current law
  bool felt_ = false;        ///< at the last evaluation: there was a law, and not a stale one
  Vec3 pressing_ = Vec3::Zero();
  Wrench unfaded_;
  double softening_ = 0;  ///< of a law too stiff for the device [m/N]; 0: not capped
  int cross_fade_ticks_ = 1, cross_fade_left_ = 0;
  Wrench cross_fade_;  ///< old minus new wrench where the new law took over
};

/// 1 up to `stale_after`, then linearly to 0 within `fade_time`; 0 for an age that is no number.
double freshness(double age, double stale_after, double fade_time);

}  // namespace palpate::haptics
