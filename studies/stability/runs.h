// What is done to the ball, with steps of any size: no world, no guards, no sub-steps.
#pragma once

#include <functional>

#include "studies/report/progress.h"
#include "studies/stability/scheme.h"

namespace palpate::stability {

using report::KeepGoing;

/// What of a body must not grow.
enum class Energy {
  kKinetic,
  kTotal,   ///< and elastic
  kMidway,  ///< the same by the mean velocity of two steps: those of symplectic Euler belong to the
            ///< middle of a step, the elastic energy to its end
  kElastic,  ///< of a kinematic model, whose velocities are moves per step
};

/// Writes down what a body does, step by step.
class Watch {
 public:
  /// @param energy  but for kKinetic, against the tolerance's or what it is after the first step if
  ///                that is more
  Watch(const TestBody& body, const Tolerance& tolerance, Energy energy);

  /// After a step. @returns false when the rest need not be looked at
  bool see(TestBody& body);
  Verdict judge(const TestBody& body);

 private:
  Tolerance tolerance_;
  Energy energy_;
  Signals signals_;
  std::vector<Vec3> rest_, before_;  ///< positions at the start, velocities before [m], [m/s]
};

/// Share of what is inside out: of a solid's tetrahedra, of a surface's triangles whose normal
/// points away from that at rest, turned as the surface turned as a whole.
double inverted_share(const deformation::OrganModel& model, const std::vector<Vec3>& positions);

inline constexpr int kSwingSteps = 400;

/// Set swinging as an ellipsoid by about 1e-3 of its radius, all other motions stirred by 1e-3 of
/// that, for kSwingSteps steps. ChainMail, which knows no velocities, is let go from there.
/// @param youngs_modulus  by which the swing's speed is chosen [Pa]
Verdict swing(const Scheme& scheme, const geometry::OrganShape& shape, double youngs_modulus,
              double h, const KeepGoing& keep_going);

/// Closed by two plates to `squeeze` of the diameter in 0.3 s and held for 0.2 s, damped.
/// @param end  if not null, gets the body at the end
Verdict squeeze(const Scheme& scheme, const geometry::OrganShape& shape, double squeeze, double h,
                const KeepGoing& keep_going, std::unique_ptr<TestBody>* end = nullptr);

/// Held below, a sphere of 20 mm goes 20 mm deep at `speed` [m/s] and comes out; 0.2 s more,
/// damped.
Verdict poke(const Scheme& scheme, const geometry::OrganShape& shape, double speed, double h,
             const KeepGoing& keep_going);

/// The organs of the last two.
scene::Organ squeezed_organ(const Scheme& scheme);
scene::Organ poked_ball(const Scheme& scheme);

}  // namespace palpate::stability
