#include "deformation/elements/quadratic_pressure.h"

#include <Eigen/LU>
#include <algorithm>

#include "deformation/elements/quadrature.h"
#include "deformation/materials/volume_ratio.h"
#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

constexpr std::size_t kLanes = kernel::kQuadraticLanes;

kernel::QuadraticKernel kernel_for(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return kernel::avx512_quadratic_kernel();
  if (set == InstructionSet::kAvx2) return kernel::avx2_quadratic_kernel();
#endif
  return kernel::portable_quadratic_kernel();
}

/// Where the metric's entries are: 11 22 33 12 13 23.
constexpr std::array<std::array<int, 2>, 6> kMetricEntries{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

/// ∂N_a/∂L_j of the nodes at the four points, by columns.
using PointShapes = Eigen::Matrix<double, 3, kElementNodes>;
const std::array<PointShapes, 4>& point_shapes() {
  static const auto shapes = [] {
    std::array<PointShapes, 4> all;
    for (int q = 0; q < 4; ++q) {
      Eigen::Vector4d at = Eigen::Vector4d::Constant(kernel::kFarCorner);
      at[q] = 1 - 3.0 * kernel::kFarCorner;
      all[static_cast<std::size_t>(q)] = quadratic_shape_gradient(at).transpose();
    }
    return all;
  }();
  return shapes;
}

Mat3 metric_of(const kernel::QuadraticBatch& batch, std::size_t lane) {
  Mat3 metric;
  for (std::size_t k = 0; k < 6; ++k) {
    const auto [i, j] = kMetricEntries[k];
    metric(i, j) = metric(j, i) = batch.metric[k][lane];
  }
  return metric;
}

}  // namespace

QuadraticPressure::QuadraticPressure(const std::vector<Vec3>& rest_positions, const TetMesh& mesh,
                                     InstructionSet set)
    : law_(mesh.elastic().shear_modulus(), kPointModulus * mesh.elastic().shear_modulus()),
      kernel_(kernel_for(set)) {
  PALPATE_DEMAND(mesh.edge_nodes.size() == mesh.tetrahedra.size());
  const double ratio = std::min(kLargestBulkModulus, mesh.elastic().bulk_over_shear());
  bulk_modulus_ = std::max(0.0, (ratio + 1.0 / 3) * law_.shear_modulus - law_.volume_modulus);
  batches_.assign((mesh.tetrahedra.size() + kLanes - 1) / kLanes, kernel::QuadraticBatch{});
  std::vector<std::uint32_t> counts(rest_positions.size() + 1, 0);
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    add_element(e, rest_positions, mesh);
    for (const auto node : elements_.back()) ++counts[node + 1];
  }
  for (std::size_t i = 1; i < counts.size(); ++i) counts[i] += counts[i - 1];
  first_element_ = counts;
  elements_of_nodes_.resize(counts.back());
  for (std::uint32_t e = 0; e < elements_.size(); ++e) {
    for (const auto node : elements_[e]) elements_of_nodes_[counts[node]++] = e;
  }
  shift_.resize(rest_positions.size());
  wide_forces_.resize(rest_positions.size());
  wide_diagonal_.resize(rest_positions.size());
  wide_mixed_z_.resize(rest_positions.size());
  forces_.assign(rest_positions.size(), Vec3::Zero());
  diagonal_.assign(rest_positions.size(), Mat3::Zero());
}

/// Neighbours in the mesh into different batches: lanes that add to one node wait for each other.
void QuadraticPressure::add_element(std::size_t e, const std::vector<Vec3>& rest_positions,
                                    const TetMesh& mesh) {
  kernel::QuadraticBatch& batch = batches_[e % batches_.size()];
  const std::size_t lane = e / batches_.size();
  const auto& corners = mesh.tetrahedra[e];
  Nodes& nodes = elements_.emplace_back();
  const auto middles = std::copy(corners.begin(), corners.end(), nodes.begin());
  std::copy(mesh.edge_nodes[e].begin(), mesh.edge_nodes[e].end(), middles);
  for (std::size_t a = 0; a < nodes.size(); ++a) batch.nodes[a][lane] = nodes[a];
  Mat3 edges;
  for (int k = 0; k < 3; ++k) {
    edges.col(k) =
        rest_positions[nodes[static_cast<std::size_t>(k) + 1]] - rest_positions[nodes[0]];
  }
  const double volume = edges.determinant() / 6;
  batch.volume[0][lane] = static_cast<float>(volume);
  batch.per_volume[0][lane] = static_cast<float>(1 / volume);
  batch.share[0][lane] = 1;
  const Mat3 inverse = edges.inverse();  // its rows: ∇L_j
  const Mat3 metric = inverse * inverse.transpose();
  for (std::size_t k = 0; k < 6; ++k) {
    batch.metric[k][lane] = static_cast<float>(metric(kMetricEntries[k][0], kMetricEntries[k][1]));
  }
}

kernel::QuadraticPass QuadraticPressure::begin_pass() {
  kernel::QuadraticPass pass;
  pass.batches = batches_.data();
  pass.batch_count = batches_.size();
  pass.shear_modulus = law_.shear_modulus;
  pass.point_modulus = law_.volume_modulus;
  pass.bulk_modulus = bulk_modulus_;
  pass.scale = static_cast<float>(scale_);
  return pass;
}

void QuadraticPressure::take_pressures_of_shape(const std::vector<Vec3>& positions,
                                                Eigen::VectorXd& pressures) {
  kernel::QuadraticPass pass = begin_pass();
  pass.positions = positions.front().data();
  kernel_.press(pass);
  pressures.resize(static_cast<Eigen::Index>(elements_.size()));
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    pressures[static_cast<Eigen::Index>(e)] =
        batches_[e % batches_.size()].pressure[0][e / batches_.size()];
  }
}

void QuadraticPressure::go_on_from(const Eigen::VectorXd& kept, const Eigen::VectorXd& shares) {
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    kernel::QuadraticBatch& batch = batches_[e % batches_.size()];
    const std::size_t lane = e / batches_.size();
    batch.pressure[0][lane] = static_cast<float>(kept[static_cast<Eigen::Index>(e)]);
    batch.share[0][lane] = static_cast<float>(shares[static_cast<Eigen::Index>(e)]);
  }
}

void QuadraticPressure::linearise(const std::vector<Vec3>& positions, double scale,
                                  std::span<const double> shift) {
  scale_ = scale;
  std::fill(wide_forces_.begin(), wide_forces_.end(), Vec4f::Zero());
  std::fill(wide_diagonal_.begin(), wide_diagonal_.end(), Vec4f::Zero());
  std::fill(wide_mixed_z_.begin(), wide_mixed_z_.end(), Vec4f::Zero());
  kernel::QuadraticPass pass = begin_pass();
  pass.positions = positions.front().data();
  pass.forces = wide_forces_.front().data();
  pass.diagonal = wide_diagonal_.front().data();
  pass.mixed_z = wide_mixed_z_.front().data();
  kernel_.linearise(pass);
  for (std::size_t i = 0; i < forces_.size(); ++i) {
    forces_[i] = wide_forces_[i].head<3>().cast<double>();
    shift_[i] = static_cast<float>(shift[i]);
    const Vec4f& own = wide_diagonal_[i];
    const double xy = own[3], xz = wide_mixed_z_[i][0], yz = wide_mixed_z_[i][1];
    diagonal_[i] << own[0], xy, xz, xy, own[1], yz, xz, yz, own[2];
    diagonal_[i].diagonal().array() += shift[i];
  }
}

void QuadraticPressure::apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) {
  for (std::size_t i = 0; i < p.size(); ++i) out[i] = shift_[i] * p[i];
  kernel::QuadraticPass pass = begin_pass();
  pass.vector = p.front().data();
  pass.product = out.front().data();
  kernel_.multiply(pass);
}

void QuadraticPressure::add_block(const Patch& patch, float share, Eigen::MatrixXf& sum) const {
  std::vector<std::uint32_t> touched;
  for (const auto node : patch.nodes) {
    sum.diagonal().segment<3>(3 * patch.place(node)).array() += share * shift_[node];
    touched.insert(touched.end(), elements_of_nodes_.begin() + first_element_[node],
                   elements_of_nodes_.begin() + first_element_[node + 1]);
  }
  std::ranges::sort(touched);
  const auto repeated = std::ranges::unique(touched);
  touched.erase(repeated.begin(), repeated.end());
  for (const auto e : touched) add_element_block(e, patch, share, sum);
}

void QuadraticPressure::add_element_block(std::size_t e, const Patch& patch, float share,
                                          Eigen::MatrixXf& sum) const {
  const kernel::QuadraticBatch& batch = batches_[e % batches_.size()];
  const std::size_t lane = e / batches_.size();
  const double per_volume = share * scale_ * batch.per_volume[0][lane];
  const double of_points = law_.volume_modulus / 144 * per_volume;
  const double of_all = batch.share[0][lane] * bulk_modulus_ / 576 * per_volume;
  const Mat3 metric = metric_of(batch, lane);
  std::array<Mat3, 4> tangents;
  std::array<PointShapes, 4> rows, raised;  // 24 V/4 ∂J/∂x; ∂N by the metric
  PointShapes all_rows = PointShapes::Zero();
  for (std::size_t q = 0; q < 4; ++q) {
    for (std::size_t k = 0; k < 9; ++k) {
      tangents[q](static_cast<int>(k % 3), static_cast<int>(k / 3)) =
          batch.tangents[9 * q + k][lane];
    }
    rows[q] = cofactor(tangents[q]) * point_shapes()[q];
    raised[q] = share * batch.shapes[q][lane] * metric * point_shapes()[q];
    all_rows += rows[q];
  }
  for (int a = 0; a < kElementNodes; ++a) {
    const int i = patch.place(elements_[e][static_cast<std::size_t>(a)]);
    for (int b = 0; b < kElementNodes && i >= 0; ++b) {
      const int j = patch.place(elements_[e][static_cast<std::size_t>(b)]);
      if (j < 0 || j > i) continue;
      Mat3 block = of_all * all_rows.col(a) * all_rows.col(b).transpose();
      for (std::size_t q = 0; q < 4; ++q) {
        const PointShapes& shapes = point_shapes()[q];
        block += of_points * rows[q].col(a) * rows[q].col(b).transpose();
        block.diagonal().array() += shapes.col(a).dot(raised[q].col(b));
        // ∂²det M/∂x_a∂x_b = −[M (∂N_a × ∂N_b)]×
        const Vec3 turn =
            share * batch.turnings[q][lane] * tangents[q] * shapes.col(a).cross(shapes.col(b));
        block.row(0) += Vec3(0, turn.z(), -turn.y());
        block.row(1) += Vec3(-turn.z(), 0, turn.x());
        block.row(2) += Vec3(turn.y(), -turn.x(), 0);
      }
      sum.block<3, 3>(3 * i, 3 * j) += block.cast<float>();
    }
  }
}

double QuadraticPressure::energy(const std::vector<Vec3>& positions) {
  kernel::QuadraticPass pass = begin_pass();
  pass.positions = positions.front().data();
  energies_.resize(kLanes * batches_.size());
  pass.energies = energies_.data();
  kernel_.measure(pass);
  double sum = 0;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    sum += energies_[kLanes * (e % batches_.size()) + e / batches_.size()];
  }
  return sum;
}

}  // namespace palpate::deformation
