// What is done to the ball, with steps of any size: no world, no guards, no sub-steps.
#pragma once

#include <functional>

#include "bench/stability/subject.h"

namespace palpate::stability {

/// Asked now and then; may throw to end a run.
using KeepGoing = std::function<void()>;

/// A thing that touches nodes, without friction.
struct Obstacle {
  Vec3 position = Vec3::Zero();  ///< centre of a sphere, a point of a plane, in W [m]
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  double radius = 0;             ///< of a sphere, > 0 [m]; 0: a plane
  Vec3 facing = Vec3::UnitZ();   ///< of a plane: unit, towards its free side
};

/// One contact row per near node and obstacle, started from the impulses of the step before.
class Touch {
 public:
  /// @param obstacles  where they are as the step begins
  void step(std::span<const Obstacle> obstacles, double h, Specimen& specimen);

 private:
  std::vector<deformation::ContactRow> rows_;
  std::vector<std::size_t> slots_;  ///< of each row, into impulses_
  std::vector<double> impulses_;    ///< [obstacle · nodes + node] [N·s]
};

/// Writes down what a specimen does, step by step.
class Watch {
 public:
  /// @param conservative  energy counts with the elastic one, against the yardstick's or what it
  ///                      is after the first step if that is more; else kinetic alone
  Watch(const Specimen& specimen, const Yardstick& yardstick, bool conservative);

  /// After a step. @returns false when the rest need not be looked at
  bool see(Specimen& specimen);
  Verdict judge(const Specimen& specimen);

 private:
  Yardstick yardstick_;
  bool conservative_;
  Signals signals_;
  std::vector<Vec3> rest_, before_;  ///< positions at the start, velocities before [m], [m/s]
};

inline constexpr int kSwingSteps = 400;

/// Set swinging as an ellipsoid by about 1e-3 of its radius, all other motions stirred by 1e-3 of
/// that, for kSwingSteps steps.
/// @param youngs_modulus  by which the swing's speed is chosen [Pa]
Verdict swing(const Subject& subject, const geometry::OrganShape& shape, double youngs_modulus,
              double h, const KeepGoing& keep_going);

/// Closed by two plates to `squeeze` of the diameter in 0.3 s and held for 0.2 s, damped.
/// @param end  if not null, gets the specimen at the end
Verdict squeeze(const Subject& subject, const geometry::OrganShape& shape, double squeeze, double h,
                const KeepGoing& keep_going, std::unique_ptr<Specimen>* end = nullptr);

/// Held below, a sphere of 20 mm goes 20 mm deep at `speed` [m/s] and comes out; 0.2 s more,
/// damped.
Verdict poke(const Subject& subject, const geometry::OrganShape& shape, double speed, double h,
             const KeepGoing& keep_going);

/// The organs of the last two.
scene::Organ squeezed_organ(const Subject& subject);
scene::Organ poked_organ(const Subject& subject);

}  // namespace palpate::stability
