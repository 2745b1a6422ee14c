// Rigid, frictionless contact of a solid's boundary with planes, spheres and capsules, by an
// augmented Lagrangian at integration points of the boundary faces.
//   P. Alart, A. Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991; T. Laursen, "Computational
//   Contact and Impact Mechanics", Springer 2002.
//
// With gap g (negative: inside the obstacle), multiplier λ ≥ 0 and penalty ε, per rest area:
//   t = max(0, λ − ε g)   traction on the tissue along the obstacle's outward normal n [Pa]
//   energy = (t² − λ²)/(2ε),   forces  N_a t n,   tangent  N_a N_b (ε n nᵀ − t ∂n/∂x)
// Between solutions λ ← t, until nothing penetrates by more than wanted. Integration points, not
// nodes, because a uniform traction on a six-node face has no force at its corners.
#pragma once

#include <span>
#include <variant>
#include <vector>

#include "deformation/contact/element_contact.h"

namespace palpate::deformation {

struct Plane {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit, towards the free side
};

struct Sphere {
  Vec3 centre = Vec3::Zero();
  double radius = 0;  ///< > 0 [m]
};

struct Capsule {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();  ///< ends of the axis, apart [m]
  double radius = 0;                        ///< > 0 [m]
};

using Obstacle = std::variant<Plane, Sphere, Capsule>;

struct Gap {
  double gap = 0;                         ///< signed distance, negative inside [m]
  Vec3 normal = Vec3::UnitZ();            ///< ∂gap/∂x, out of the obstacle
  Mat3 normal_derivative = Mat3::Zero();  ///< ∂normal/∂x [1/m]
};

Gap gap_at(const Obstacle& obstacle, const Vec3& position);

struct ContactOutcome {
  Vec3 force = Vec3::Zero();  ///< on the obstacle [N]
  double deepest = 0;         ///< largest penetration, ≥ 0 [m]
  std::size_t touching = 0;   ///< integration points with traction
};

class RigidContact : public ElementContact {
 public:
  /// @param solid    outlives this
  /// @param faces    of its mesh that may touch: indices into mesh().faces
  /// @param penalty  ε > 0 [Pa/m]
  RigidContact(const TaylorHoodElements& solid, std::vector<std::uint32_t> faces, double penalty);

  /// Places the obstacles; multipliers of the same count of obstacles are kept.
  void set_obstacles(std::vector<Obstacle> obstacles);
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  void set_penalty(double penalty);  ///< ε > 0 [Pa/m]

  void add_residual(std::size_t element, const SolidState& state,
                    ElementVector& residual) const override;
  void add_tangent(std::size_t element, const SolidState& state, ElementMatrix& tangent,
                   bool positive) const override;
  double deepest(const SolidState& state) const override;
  /// λ ← max(0, λ − ε g)
  void augment(const SolidState& state) override;

  /// One per obstacle.
  std::vector<ContactOutcome> outcomes(const SolidState& state) const;

  /// λ of all points, for keeping and giving back.
  const std::vector<double>& multipliers() const { return multipliers_; }
  void set_multipliers(std::vector<double> multipliers);
  /// λ = 0
  void forget_multipliers();

 private:
  struct Point {
    Gap gap;
    double traction = 0;  ///< t [Pa]
  };
  static constexpr int kPoints = 6;

  Vec3 position(const BoundaryFace& face, int point, const SolidState& state) const;
  Point evaluate(std::size_t obstacle, std::size_t candidate, int point,
                 const SolidState& state) const;
  /// Calls f(point, its area at rest, nodes of its face in the element, their shape there) for
  /// every point of the element that bears traction.
  template <class F>
  void for_touching(std::size_t element, const SolidState& state, const F& f) const;
  std::size_t index(std::size_t obstacle, std::size_t candidate, int point) const {
    return (obstacle * faces_.size() + candidate) * kPoints + static_cast<std::size_t>(point);
  }

  const TaylorHoodElements& solid_;
  std::vector<std::uint32_t> faces_;
  double penalty_ = 0;
  std::vector<std::array<double, kPoints>> areas_;    ///< of the points at rest [m²]
  std::vector<std::vector<std::size_t>> of_element_;  ///< candidates of each element
  std::vector<Obstacle> obstacles_;
  std::vector<double> multipliers_;  ///< λ [Pa]  (obstacles × faces × points)
};

}  // namespace palpate::deformation
