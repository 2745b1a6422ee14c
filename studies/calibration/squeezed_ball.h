// A ball between two frictionless plates, brought to rest at one compression after the other.
#pragma once

#include "studies/rigs/squeezed_ball.h"
#include "studies/rigs/test_body.h"

namespace palpate::calibration {

struct BallSetup {
  scene::Organ organ;          ///< tissue and springs; mesh, name and integrator are not looked at
  double outer_radius = 0.05;  ///< R of the ball the plates touch [m]
  double surface_depth = 0;    ///< of the node surface under the outer one: t/2 for the middle of
                               ///< a wall, 0 if the nodes are the outer surface [m]
};

/// 10·4ⁿ + 2 nodes.
std::size_t node_count(int levels);

struct Equilibrium {
  double compression = 0;        ///< approach of the plates / 2 R
  double force = 0;              ///< on one plate, mean of the two [N]
  double pressure = 0;           ///< of the contents [Pa]
  double equatorial_radius = 0;  ///< of the outer surface [m]
  bool settled = false;          ///< false: still moved when time was up
};

/// Quasi-static squeezing by damped steps of the simulator itself. The plates move at 20 mm/s to
/// the wanted compression and stay until, over 0.1 s, all of these hold (else at most 6 s):
///   1. the force changed by no more than 2e-4 of it,
///   2. the two plates' forces agree within 1e-3 of it,
///   3. the kinetic energy is below 1e-6 of the elastic energy.
/// Deterministic. Mass and damping shape the way there, not the equilibrium.
class SqueezedBall {
 public:
  /// @param levels  of the icosphere, 0 … 7
  SqueezedBall(const BallSetup& setup, int levels);

  /// @param compression  not less than that of the call before, < 1
  Equilibrium squeeze_to(double compression);

 private:
  void advance_plates_to(double height);
  double mean_equatorial_radius() const;

  double outer_radius_, surface_depth_;
  rigs::TestBody body_;
  rigs::Plates plates_;
  double rest_equator_ = 0;  ///< [m]
};

}  // namespace palpate::calibration
