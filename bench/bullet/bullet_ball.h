// The squeezed ball by Bullet's soft body (Debian: libbullet-dev 3.24).
#pragma once

#include "bench/bullet/squeezed_ball.h"

namespace palpate::bench {

struct BulletSettings {
  int position_iterations = 1;  ///< m_cfg.piterations
  /// Penalty on the volume, as pressure per relative volume error: kVC = K/V₀ [Pa]; 0 = off
  double volume_stiffness = 0;
  /// Gas pressure at rest: kPR = p₀ V₀ [Pa]; 0 = off
  double gas_pressure = 0;
};

/// A btSoftBody of the same nodes, masses, triangles and springs (each a link), between two
/// kinematic boxes in a btSoftRigidDynamicsWorld; contacts by signed distance, fully hard.
///
/// Bullet's links have no stiffness in N/m but a factor kLST of the position correction per
/// iteration. Each link gets the one with which a single iteration equals an implicit step of its
/// spring: kLST = k h² w/(1 + k h² w), w = 1/m_a + 1/m_b. More iterations make it stiffer: that is
/// the method.
/// Bullet computes in float and recommends objects of about one unit: lengths are scaled so that
/// the ball's radius is 1.
/// The solver's time is that of a whole step less the world's search for collisions; it holds the
/// upkeep of the nodes' bounding volumes, which Bullet does while it moves them.
class BulletBall : public Squeezer {
 public:
  BulletBall(const Ball& ball, const BulletSettings& settings);
  ~BulletBall() override;

  void step(double height) override;
  double volume() const override;
  /// By what its volume terms ask for.
  double pressure() const override;
  std::size_t contact_count() const override;
  double depth_beyond(double height) const override;
  double solver_seconds() const override;

 private:
  struct World;
  std::unique_ptr<World> world_;
  BulletSettings settings_;
};

}  // namespace palpate::bench
