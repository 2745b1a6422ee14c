#include "deformation/elements/average_nodal_pressure.h"

#include <algorithm>
#include <cmath>

namespace palpate::deformation {
namespace {

/// ∂v/∂x by columns, v the volume of the tetrahedron [m²].
Mat34 area_vectors(const geometry::Tetrahedron& t, const std::vector<Vec3>& x) {
  const Vec3 u = x[t[1]] - x[t[0]], v = x[t[2]] - x[t[0]], w = x[t[3]] - x[t[0]];
  Mat34 areas;
  areas.col(1) = v.cross(w) / 6;
  areas.col(2) = w.cross(u) / 6;
  areas.col(3) = u.cross(v) / 6;
  areas.col(0) = -(areas.col(1) + areas.col(2) + areas.col(3));
  return areas;
}

/// Bound of the largest singular value, exact where the other two are equal: H. Wolkowicz,
/// G. Styan, Linear Algebra Appl. 29, 1980.
double largest_stretch(const Mat3& F) {
  const Mat3 C = F.transpose() * F;
  const double mean = C.trace() / 3;
  const double spread = std::max(0.0, C.squaredNorm() / 3 - mean * mean);
  return std::sqrt(mean + std::sqrt(2 * spread));
}

/// ∂²v/∂x_a∂x_b = [x_c − x_d]×/6 for the corners {a, b, c, d}.
constexpr std::array<std::array<std::size_t, 4>, 6> kOppositeEdges{
    {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}}};

/// [e]×
Block4f skew(const Vec4f& e) {
  return {Vec4f(0, e[2], -e[1], 0), Vec4f(-e[2], 0, e[0], 0), Vec4f(e[1], -e[0], 0, 0)};
}

}  // namespace

double nodal_bulk_modulus(const ElasticConstants& tissue,
                          const AverageNodalPressureSettings& settings) {
  const double ratio = std::min(settings.largest_bulk_modulus, tissue.bulk_over_shear());
  const double mu = tissue.shear_modulus(), alpha = settings.stabilisation * mu;
  return std::max(0.0, ratio * mu - (alpha - mu / 3));
}

AverageNodalPressure::AverageNodalPressure(LinearTetrahedra tetrahedra,
                                           const ElasticConstants& tissue,
                                           const AverageNodalPressureSettings& settings)
    : tetrahedra_(std::move(tetrahedra)),
      law_(tissue.shear_modulus(), settings.stabilisation * tissue.shear_modulus()),
      pairs_(tetrahedra_.node_count, tetrahedra_.corners),
      matrix_(pairs_),
      nodal_modulus_(nodal_bulk_modulus(tissue, settings)) {
  node_volumes_.assign(tetrahedra_.node_count, 0);
  shape_weights_.assign(pairs_.pair_count(), 0);
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const double volume = tetrahedra_.volumes[e];
    for (const auto node : tetrahedra_.corners[e]) node_volumes_[node] += volume / 4;
    const Eigen::Matrix4d weights =
        volume * tetrahedra_.gradients[e].transpose() * tetrahedra_.gradients[e];
    for (int k = 0; k < 16; ++k) {
      shape_weights_[pairs_.of_elements[e][static_cast<std::size_t>(k)]] += weights(k / 4, k % 4);
    }
  }
  areas_.resize(tetrahedra_.size());
  volumes_.resize(tetrahedra_.size());
  node_pressures_.resize(tetrahedra_.node_count);
  kept_.setZero(static_cast<Eigen::Index>(tetrahedra_.node_count));
  shares_.setOnes(kept_.size());
  volume_rows_.resize(pairs_.pair_count());
  forces_.assign(tetrahedra_.node_count, Vec3::Zero());
  diagonal_.assign(tetrahedra_.node_count, Mat3::Zero());
}

void AverageNodalPressure::take_pressures_of_shape(const std::vector<Vec3>& positions,
                                                   Eigen::VectorXd& pressures) {
  take_volumes(positions);
  pressures = Eigen::Map<const Eigen::VectorXd>(node_pressures_.data(), kept_.size());
}

void AverageNodalPressure::go_on_from(const Eigen::VectorXd& kept, const Eigen::VectorXd& shares) {
  kept_ = kept;
  shares_ = shares;
}

void AverageNodalPressure::linearise(const std::vector<Vec3>& positions, double scale,
                                     std::span<const double> shift) {
  take_volumes(positions);
  for (std::size_t i = 0; i < node_pressures_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    node_pressures_[i] = kept_[k] + shares_[k] * node_pressures_[i];
  }
  matrix_.set_zero();
  add_shape_forces(positions);
  std::fill(volume_rows_.begin(), volume_rows_.end(), Vec4f::Zero());
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) add_tetrahedron(e, positions, scale);
  for (std::size_t i = 0; i < shift.size(); ++i) {
    matrix_.add(pairs_.diagonals[i], static_cast<float>(shift[i]));
    for (auto k = pairs_.diagonals[i]; k < pairs_.row_starts[i + 1]; ++k) {
      matrix_.add(k, static_cast<float>(scale * law_.shear_modulus * shape_weights_[k]));
    }
  }
  matrix_.mirror();
  add_pressures(scale);
}

void AverageNodalPressure::take_volumes(const std::vector<Vec3>& positions) {
  std::fill(node_pressures_.begin(), node_pressures_.end(), 0);
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const auto& corners = tetrahedra_.corners[e];
    areas_[e] = area_vectors(corners, positions);
    volumes_[e] = areas_[e].col(3).dot(positions[corners[3]] - positions[corners[0]]);
    for (const auto node : corners) node_pressures_[node] += volumes_[e] / 4;
  }
  for (std::size_t i = 0; i < node_volumes_.size(); ++i) {
    node_pressures_[i] = nodal_modulus_ * (node_pressures_[i] / node_volumes_[i] - 1);
  }
}

/// −μ Σ_e V_e (g_a·g_b) x_b; the weights of a row have sum 0.
void AverageNodalPressure::add_shape_forces(const std::vector<Vec3>& positions) {
  for (std::size_t i = 0; i < forces_.size(); ++i) {
    Vec3 sum = Vec3::Zero();
    for (auto k = pairs_.row_starts[i]; k < pairs_.row_starts[i + 1]; ++k) {
      sum += shape_weights_[k] * (positions[i] - positions[pairs_.columns[k]]);
    }
    forces_[i] = law_.shear_modulus * sum;
  }
}

void AverageNodalPressure::add_tetrahedron(std::size_t e, const std::vector<Vec3>& positions,
                                           double scale) {
  const auto& corners = tetrahedra_.corners[e];
  const auto& pairs = pairs_.of_elements[e];
  const double J = volumes_[e] / tetrahedra_.volumes[e];
  double pull = law_.volume_derivative(J);
  for (const auto node : corners) pull += node_pressures_[node] / 4;
  std::array<Vec4f, 4> areas, scaled;
  const float own = static_cast<float>(scale * law_.volume_modulus / tetrahedra_.volumes[e]);
  for (std::size_t a = 0; a < 4; ++a) {
    forces_[corners[a]] -= pull * areas_[e].col(static_cast<int>(a));
    areas[a] = wide(areas_[e].col(static_cast<int>(a)));
    scaled[a] = own * areas[a];
    for (std::size_t b = 0; b < 4; ++b) volume_rows_[pairs[4 * b + a]] += areas[a];
  }
  const double stretch = largest_stretch(tetrahedra_.deformation_gradient(e, positions));
  const double kept = kept_turning(pull, stretch, J);
  const double made_up = 2 * stretch * std::abs(pull - kept) * tetrahedra_.volumes[e];
  const Eigen::Matrix4d shape =
      scale * made_up * tetrahedra_.gradients[e].transpose() * tetrahedra_.gradients[e];
  const auto add_shape = [&](std::size_t a, std::size_t b, Block4f block) {
    const auto own_shape = static_cast<float>(shape(static_cast<int>(a), static_cast<int>(b)));
    for (int k = 0; k < 3; ++k) block[static_cast<std::size_t>(k)][k] += own_shape;
    matrix_.add(pairs[4 * a + b], block);
  };
  for (std::size_t a = 0; a < 4; ++a) add_shape(a, a, outer(scaled[a], areas[a]));
  for (auto [a, b, c, d] : kOppositeEdges) {
    if (corners[a] > corners[b]) std::swap(a, b), std::swap(c, d);
    Block4f block = outer(scaled[a], areas[b]);
    const Vec3 edge = positions[corners[c]] - positions[corners[d]];
    const Block4f turn = skew(wide(scale / 6 * kept * edge));
    for (std::size_t k = 0; k < 3; ++k) block[k] += turn[k];
    add_shape(a, b, block);
  }
}

/// Not above μ/σ for shears and rotations; for the three stretches σ_i, after scaling by them,
/// from (t − αJ) J Σ 1/(μσ_i² + tJ) ≤ 1 with σ_i ≥ J/σ² and t = −c'.
double AverageNodalPressure::kept_turning(double c, double stretch, double J) const {
  const double fourth = std::pow(stretch, 4);
  const double limit =
      std::min(law_.shear_modulus / stretch,
               std::max(J, 0.0) * (3 * law_.volume_modulus + law_.shear_modulus / fourth) / 2);
  return std::clamp(c, -limit, 0.0);
}

/// Scales the volumes' gradients, and takes the diagonal.
void AverageNodalPressure::add_pressures(double scale) {
  for (std::size_t i = 0; i < diagonal_.size(); ++i) diagonal_[i] = matrix_.diagonal(i);
  for (std::size_t i = 0; i < node_volumes_.size(); ++i) {
    const auto weight = static_cast<float>(std::sqrt(scale * shares_[static_cast<Eigen::Index>(i)] *
                                                     nodal_modulus_ / node_volumes_[i]) /
                                           4);
    for (auto k = pairs_.row_starts[i]; k < pairs_.row_starts[i + 1]; ++k) {
      volume_rows_[k] *= weight;
      const Vec3 row = volume_rows_[k].head<3>().cast<double>();
      diagonal_[pairs_.columns[k]] += row * row.transpose();
    }
  }
}

void AverageNodalPressure::apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) {
  matrix_.apply(p, out);
  for (std::size_t i = 0; i < node_volumes_.size(); ++i) {
    Vec4f products = Vec4f::Zero();
    for (auto k = pairs_.row_starts[i]; k < pairs_.row_starts[i + 1]; ++k) {
      products += volume_rows_[k].cwiseProduct(p[pairs_.columns[k]]);
    }
    const float rate = products.sum();
    for (auto k = pairs_.row_starts[i]; k < pairs_.row_starts[i + 1]; ++k) {
      out[pairs_.columns[k]] += rate * volume_rows_[k];
    }
  }
}

void AverageNodalPressure::add_block(const Patch& patch, float share, Eigen::MatrixXf& sum) const {
  matrix_.add_block(patch, share, sum);
  for (std::size_t i = 0; i < node_volumes_.size(); ++i) {
    for (auto k = pairs_.row_starts[i]; k < pairs_.row_starts[i + 1]; ++k) {
      const int a = patch.place(pairs_.columns[k]);
      if (a < 0) continue;
      const Eigen::Vector3f row = share * volume_rows_[k].head<3>();
      for (auto l = pairs_.row_starts[i]; l < pairs_.row_starts[i + 1]; ++l) {
        const int b = patch.place(pairs_.columns[l]);
        if (b < 0 || b > a) continue;
        sum.block<3, 3>(3 * a, 3 * b) += row * volume_rows_[l].head<3>().transpose();
      }
    }
  }
}

double AverageNodalPressure::energy(const std::vector<Vec3>& positions) {
  take_volumes(positions);
  double sum = 0;
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const Mat3 F = tetrahedra_.deformation_gradient(e, positions);
    const double J = volumes_[e] / tetrahedra_.volumes[e];
    sum += tetrahedra_.volumes[e] * law_.energy_density(F.squaredNorm(), J);
  }
  for (std::size_t i = 0; i < node_volumes_.size() && nodal_modulus_ > 0; ++i) {
    sum += node_volumes_[i] * node_pressures_[i] * node_pressures_[i] / (2 * nodal_modulus_);
  }
  return sum;
}

}  // namespace palpate::deformation
