// Elements that make up a body's elastic forces, as an implicit step needs them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "deformation/model/patch.h"
#include "modules/core/simd_vectors.h"

namespace palpate::deformation {

/// Of elements that keep their volume by pressures of their own.
struct ElementPressures {
  std::size_t count = 0;     ///< 0: there are none
  double modulus = 0;        ///< κ' [Pa]
  double shear_modulus = 0;  ///< μ [Pa]
};

/// Elastic forces f(x) of a body's nodes and, about x, the matrix A = diag(shift) + scale K that a
/// step solves with: K approximates −∂f/∂x and is symmetric positive semidefinite. Keeps no state
/// but buffers and what go_on_from() gave. Rows of fixed nodes are like any other.
class ElasticForceElements {
 public:
  virtual ~ElasticForceElements() = default;

  /// Takes forces and A at these positions [m]  (node_count).
  /// @param scale  > 0; h² of a step [s²]
  /// @param shift  > 0, each for the three coordinates of a node [kg]  (node_count)
  virtual void linearise(const std::vector<Vec3>& positions, double scale,
                         std::span<const double> shift) = 0;

  /// For steps that remember pressures (augmented_pressures.h).
  virtual ElementPressures pressures() const { return {}; }
  /// Writes κ' ε of the shapes at these positions [Pa] to `pressures`, which is resized (count).
  virtual void take_pressures_of_shape(const std::vector<Vec3>&, Eigen::VectorXd&) {}
  /// linearise() takes pressures `kept` + share κ' ε(x) from now on, and K goes with that. Before
  /// this was called all shares are 1 and nothing is kept.  (count)
  virtual void go_on_from(const Eigen::VectorXd& /*kept*/, const Eigen::VectorXd& /*shares*/) {}

  virtual const std::vector<Vec3>& forces() const = 0;    ///< f [N]  (node_count)
  virtual const std::vector<Mat3>& diagonal() const = 0;  ///< 3×3 blocks of A [kg]  (node_count)

  /// out = A p. @param p, out  (node_count)
  virtual void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) = 0;

  /// Adds `share` of A's block of the patch to the lower triangle of `sum`.
  virtual void add_block(const Patch& patch, float share, Eigen::MatrixXf& sum) const = 0;

  virtual double energy(const std::vector<Vec3>& positions) = 0;  ///< [J]
};

}  // namespace palpate::deformation
