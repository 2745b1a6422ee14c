#include "deformation/force_error.h"

#include <algorithm>
#include <numeric>

#include "deformation/contact/touch_follower.h"
#include "deformation/elements/linear_tetrahedra.h"
#include "deformation/elements/quadratic_mesh.h"
#include "deformation/elements/quadrature.h"
#include "deformation/materials/stable_neo_hookean.h"

namespace palpate::deformation {
namespace {

constexpr double kReach = 5;
constexpr double kLeastStrain = 1e-9;  ///< what rounding makes is some 1e-15
/// Of the volume each point keeps for itself, over μ: as the elements of average_nodal_pressure.h.
/// The pressure of tissue that keeps its volume holds no energy.
constexpr double kVolumeModulus = 0.5;

/// F at the four corners of a tetrahedron, between which it is linear.
using CornerGradients = std::array<Mat3, 4>;

/// ∫ ‖A‖² dV over V of what is linear between corners.
double integral(const CornerGradients& a, double volume) {
  double squares = 0;
  Mat3 sum = Mat3::Zero();
  for (const Mat3& corner : a) {
    squares += corner.squaredNorm();
    sum += corner;
  }
  return volume / 20 * (squares + sum.squaredNorm());
}

class NearTetrahedra {
 public:
  NearTetrahedra(const OrganModel& solid, std::span<const Vec3> positions, const TouchedPart& part)
      : numbers_(those_near(solid, part)),
        tetrahedra_(solid.rest_positions, corners_of(solid.mesh(), numbers_)) {
    const TetMesh& mesh = solid.mesh();
    for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
      CornerGradients F;
      F.fill(tetrahedra_.deformation_gradient(e, positions));
      if (!mesh.edge_nodes.empty()) add_bulges(e, mesh.edge_nodes[numbers_[e]], positions, F);
      gradients_.push_back(F);
    }
  }

  /// η² over μ/2 [m³].
  double error() const {
    const std::vector<Mat3> smooth = means();
    double sum = 0;
    for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
      CornerGradients difference;
      for (std::size_t k = 0; k < 4; ++k) {
        difference[k] = smooth[tetrahedra_.corners[e][k]] - gradients_[e][k];
      }
      sum += integral(difference, tetrahedra_.volumes[e]);
    }
    return sum;
  }

  double volume() const {
    return std::accumulate(tetrahedra_.volumes.begin(), tetrahedra_.volumes.end(), 0.0);
  }

  /// U over μ/2 [m³].
  double energy() const {
    const StableNeoHookean law(2, 2 * kVolumeModulus);
    double sum = 0;
    for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
      for (const TetrahedronPoint& point : four_point_rule()) {
        Mat3 F = Mat3::Zero();
        for (std::size_t k = 0; k < 4; ++k) {
          F += point.barycentric[static_cast<Eigen::Index>(k)] * gradients_[e][k];
        }
        sum += point.weight * tetrahedra_.volumes[e] * law.energy_density(F);
      }
    }
    return sum;
  }

 private:
  static std::vector<std::size_t> those_near(const OrganModel& solid, const TouchedPart& part) {
    std::vector<std::size_t> near;
    const auto& tetrahedra = solid.mesh().tetrahedra;
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
      Vec3 centre = Vec3::Zero();
      for (const std::uint32_t corner : tetrahedra[e]) centre += solid.rest_positions[corner] / 4;
      if ((centre - part.centre).squaredNorm() < part.reach * part.reach) near.push_back(e);
    }
    return near;
  }

  static std::vector<geometry::Tetrahedron> corners_of(const TetMesh& mesh,
                                                       const std::vector<std::size_t>& numbers) {
    std::vector<geometry::Tetrahedron> corners;
    for (const std::size_t number : numbers) corners.push_back(mesh.tetrahedra[number]);
    return corners;
  }

  /// What the middles of edges, which are not halfway between the ends, add to F at the corners:
  /// 4 u (L_a g_b + L_b g_a).
  void add_bulges(std::size_t e, const std::array<std::uint32_t, 6>& middles,
                  std::span<const Vec3> positions, CornerGradients& F) const {
    for (std::size_t m = 0; m < middles.size(); ++m) {
      const auto [a, b] = kTetrahedronEdges[m];
      const auto& corners = tetrahedra_.corners[e];
      const auto &x_a = positions[corners[a]], &x_b = positions[corners[b]];
      const Vec3 bulge = 4 * (positions[middles[m]] - (x_a + x_b) / 2);
      const Mat34& g = tetrahedra_.gradients[e];
      F[a] += bulge * g.col(static_cast<Eigen::Index>(b)).transpose();
      F[b] += bulge * g.col(static_cast<Eigen::Index>(a)).transpose();
    }
  }

  /// F* at the corners, 0 elsewhere: of the near tetrahedra about each, by volume.
  std::vector<Mat3> means() const {
    std::vector<Mat3> sums(tetrahedra_.node_count, Mat3::Zero());
    std::vector<double> volumes(tetrahedra_.node_count, 0);
    for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t node = tetrahedra_.corners[e][k];
        sums[node] += tetrahedra_.volumes[e] * gradients_[e][k];
        volumes[node] += tetrahedra_.volumes[e];
      }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
      if (volumes[i] > 0) sums[i] /= volumes[i];
    }
    return sums;
  }

  std::vector<std::size_t> numbers_;  ///< in the mesh
  LinearTetrahedra tetrahedra_;
  std::vector<CornerGradients> gradients_;
};

}  // namespace

TouchedPart touched_part(const ProbeContacts& probe, std::uint32_t organ, const Body& body) {
  TouchedPart part;
  double weights = 0, away = 0;
  const auto each = [&](const auto& take) {
    for (const CarriedContact& contact : probe.contacts()) {
      const double weight = contact.pushed.norm();
      if (contact.organ != organ || !(weight > 0)) continue;
      const geometry::Triangle& t = body.triangles[contact.triangle];
      const auto& x = body.rest_positions;
      const double edges =
          (x[t[1]] - x[t[0]]).norm() + (x[t[2]] - x[t[1]]).norm() + (x[t[0]] - x[t[2]]).norm();
      take(weight,
           contact.barycentric[0] * x[t[0]] + contact.barycentric[1] * x[t[1]] +
               contact.barycentric[2] * x[t[2]],
           edges / 3);
    }
  };
  each([&](double weight, const Vec3& place, double length) {
    part.centre += weight * place;
    part.edge += weight * length;
    weights += weight;
  });
  if (!(weights > 0)) return {};
  part.centre /= weights;
  part.edge /= weights;
  part.probe_radius = probe.radius();
  each([&](double, const Vec3& place, double) {
    away = std::max(away, (place - part.centre).norm());
  });
  part.reach = kReach * (away + part.edge);
  return part;
}

double estimated_force_error(const OrganModel& solid, std::span<const Vec3> positions,
                             const TouchedPart& part) {
  const NearTetrahedra near(solid, positions, part);
  const double error = near.error(), energy = near.energy();
  if (!(energy > kLeastStrain * kLeastStrain * near.volume())) return 0;
  double found = 2 * error < energy ? error / (energy - error) : 1;
  if (part.probe_radius > 0) {
    const double apart = solid.mesh().edge_nodes.empty() ? part.edge : part.edge / 2;
    found = std::max(found, force_error_of_edge(apart / part.probe_radius));
  }
  return std::min(found, 1.0);
}

}  // namespace palpate::deformation
