// A solid organ pressed slowly by rigid, frictionless shapes, and brought to rest at one depth
// after the other.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "deformation/steppers/organ_dynamics.h"
#include "modules/geometry/tet_mesh.h"

namespace palpate::solids_bench {

/// A rigid sphere, or a plate as a sphere of radius 0 whose normal is given.
struct Press {
  Vec3 start = Vec3::Zero();       ///< centre, or a point of the plate, at depth 0 [m]
  Vec3 direction = Vec3::UnitZ();  ///< unit; it moves there by share × depth
  double share = 1;
  double radius = 0;  ///< of the sphere; 0: a plate across `direction` [m]
};

struct Rest {
  double depth = 0;
  double force = 0;  ///< on one press, mean of all [N]
  bool settled = false;
  double iterations = 0;        ///< of conjugate gradients, mean per step
  double seconds_per_step = 0;  ///< least of the holds' means, contacts included
  double volume_ratio = 0;      ///< V/V₀
};

/// @return a new solver for the organ
using MakeDynamics =
    std::function<std::unique_ptr<deformation::OrganDynamics>(const deformation::OrganModel&)>;

/// Presses move at 20 mm/s and stay until, over 0.1 s, the force changed by no more than 5e-4 of it
/// and the presses agree within 2e-3; at most 4 s. Deterministic but for the times.
class PressedSolid {
 public:
  PressedSolid(const scene::Organ& organ, const geometry::TetMesh& mesh, std::vector<Press> presses,
               const MakeDynamics& make, double step);

  /// @param depth  not less than that of the call before [m]
  Rest press_to(double depth);

  const deformation::OrganModel& model() const { return model_; }
  const deformation::OrganState& state() const { return state_; }
  deformation::OrganDynamics& dynamics() { return *dynamics_; }

 private:
  void advance_to(double depth);
  void touch_nodes(std::size_t press);
  void touch_triangles(std::size_t press);
  void add_row(std::size_t press, std::size_t key, const geometry::Triangle& nodes,
               const Vec3& weights, const Vec3& way, const Vec3& normal);
  std::vector<double> forces() const;

  deformation::OrganModel model_;
  std::vector<Press> presses_;
  double step_, depth_ = 0;
  std::unique_ptr<deformation::OrganDynamics> dynamics_;
  deformation::OrganState state_;
  std::vector<deformation::ContactRow> rows_;
  std::vector<std::size_t> row_presses_, row_keys_;
  std::vector<double> normal_impulses_;  ///< by press and node or triangle, in the last step [N·s]
};

/// Plates below and above a ball; depth is their approach.
std::vector<Press> ball_plates(double radius);
/// Sphere of radius r over the point (0, 0, height).
std::vector<Press> sphere_over(double radius, double height);

}  // namespace palpate::solids_bench
