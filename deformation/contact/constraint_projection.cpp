#include "deformation/contact/constraint_projection.h"

#include <algorithm>

namespace palpate::deformation {
namespace {

/// Contacts may depend on each other (two on one node): this part of S's diagonal is added, which
/// leaves as much of a velocity along a row as it should remove.
constexpr double kCompliance = 1e-9;
/// Below this part of gᵀWg the contacts hold all the volume that can move.
constexpr double kVanishedInverseMass = 1e-9;
/// A projection that leaves less than this part of r·W r is mostly rounding: it is done again,
/// without what the rows took.
constexpr double kMostlyTaken = 1e-4;

/// Whether none of the nodes it acts on can move.
bool is_held(std::span<const Mat3> inverse_mass_blocks, const ContactRow& contact) {
  for (int k = 0; k < 3; ++k) {
    if (contact.weights[k] != 0 && !inverse_mass_blocks[contact.nodes[k]].isZero(0)) return false;
  }
  return true;
}

}  // namespace

void ConstraintProjection::prepare(std::span<const Mat3> inverse_mass_blocks,
                                   std::span<const Vec3> gradient,
                                   std::span<const ContactRow> contacts) {
  take_inverse_masses(inverse_mass_blocks);
  collect_rows(inverse_mass_blocks, contacts);
  if (!rows_.empty()) factor_contacts(inverse_mass_blocks);
  prepare_volume(gradient);
  all_mu_.setZero(static_cast<Eigen::Index>(rows_.size()));
  all_volume_mu_ = volume_mu_ = 0;
}

void ConstraintProjection::take_inverse_masses(std::span<const Mat3> inverse_mass_blocks) {
  inverse_mass_blocks_.resize(inverse_mass_blocks.size());
  ranges_.each(inverse_mass_blocks.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        inverse_mass_blocks_[i][static_cast<std::size_t>(axis)] =
            wide(inverse_mass_blocks[i].col(axis));
      }
    }
  });
}

void ConstraintProjection::collect_rows(std::span<const Mat3> inverse_mass_blocks,
                                        std::span<const ContactRow> contacts) {
  rows_.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const ContactRow& contact = contacts[c];
    if (contact.normal_impulse <= 0 || contact.yielding > 0) continue;
    if (is_held(inverse_mass_blocks, contact)) continue;
    rows_.push_back({c, contact.nodes, contact.weights, contact.normal});
  }
}

void ConstraintProjection::factor_contacts(std::span<const Mat3> inverse_mass_blocks) {
  // Rows meet at nodes: (node, row, W b d) sorted by node.
  struct Visit {
    std::uint32_t node;
    int row;
    Vec3 arm, answer;
  };
  std::vector<Visit> visits;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    for (int k = 0; k < 3; ++k) {
      if (rows_[r].weights[k] == 0) continue;
      const Vec3 arm = rows_[r].weights[k] * rows_[r].normal;
      visits.push_back({rows_[r].nodes[k], static_cast<int>(r), arm,
                        inverse_mass_blocks[rows_[r].nodes[k]] * arm});
    }
  }
  std::stable_sort(visits.begin(), visits.end(),
                   [](const Visit& a, const Visit& b) { return a.node < b.node; });
  std::vector<Eigen::Triplet<double>> entries;
  for (auto begin = visits.begin(); begin != visits.end();) {
    auto end = begin;
    while (end != visits.end() && end->node == begin->node) ++end;
    for (auto a = begin; a != end; ++a) {
      for (auto b = begin; b <= a; ++b) {  // the lower triangle: rows rise within a node
        const double entry = a->arm.dot(b->answer);
        entries.emplace_back(a->row, b->row, a == b ? (1 + kCompliance) * entry : entry);
      }
    }
    begin = end;
  }
  const auto size = static_cast<Eigen::Index>(rows_.size());
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  factor_.compute(matrix);
}

void ConstraintProjection::prepare_volume(std::span<const Vec3> gradient) {
  const std::size_t count = inverse_mass_blocks_.size();
  gradient_.resize(count);
  volume_response_.resize(count);
  ranges_.each(count, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      gradient_[i] = i < gradient.size() ? wide(gradient[i]) : Vec4f(Vec4f::Zero());
      volume_response_[i] = apply_inverse_mass(i, gradient_[i]);
    }
  });
  const double unhindered = sums_of(gradient_, volume_response_).r_z;
  if (!rows_.empty()) {
    volume_shares_ = factor_.solve(times_rows(volume_response_));
    subtract_rows(volume_shares_, gradient_, volume_response_);
  }
  volume_inverse_mass_ = sums_of(gradient_, volume_response_).r_z;
  if (!(volume_inverse_mass_ > kVanishedInverseMass * unhindered)) volume_inverse_mass_ = 0;
}

double ConstraintProjection::project(std::vector<Vec4f>& r, std::vector<Vec4f>& z) {
  double descent = 0;
  for (int pass = 0; pass < 2; ++pass) {
    const auto mu = static_cast<float>(volume_mu_);
    ranges_.each(r.size(), [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        r[i] -= mu * gradient_[i];
        z[i] = apply_inverse_mass(i, r[i]);
      }
    });
    const Sums sums = sums_of(r, z);
    descent = hold_rows(sums, r, z);
    if (descent > kMostlyTaken * sums.r_z) break;
  }
  add(-volume_mu_, volume_response_, z);
  return descent;
}

double ConstraintProjection::descend(double step, const AlignedVector<WideNode>& p,
                                     const std::vector<Vec4f>& q, std::vector<Vec4f>& x,
                                     std::vector<Vec4f>& r, std::vector<Vec4f>& z) {
  const auto factor = static_cast<float>(step), mu = static_cast<float>(volume_mu_);
  const auto sums = ranges_.sums(r.size(), [&](std::size_t begin, std::size_t end) {
    Ranges::Sums part{};
    for (std::size_t first = begin; first < end; first += kDotBlock) {
      Vec4f r_z = Vec4f::Zero(), g_z = Vec4f::Zero();
      for (std::size_t i = first; i < std::min(first + kDotBlock, end); ++i) {
        x[i] += factor * p[i].vector;
        const Vec4f rest = r[i] - factor * q[i] - mu * gradient_[i];
        r[i] = rest;
        const Vec4f velocity = apply_inverse_mass(i, rest);
        z[i] = velocity;
        r_z += rest.cwiseProduct(velocity);
        g_z += gradient_[i].cwiseProduct(velocity);
      }
      part[0] += static_cast<double>(r_z.sum());
      part[1] += static_cast<double>(g_z.sum());
    }
    return part;
  });
  return hold_rows({sums[0], sums[1]}, r, z);
}

ConstraintProjection::Sums ConstraintProjection::sums_of(const std::vector<Vec4f>& r,
                                                         const std::vector<Vec4f>& z) {
  const auto sums = ranges_.sums(r.size(), [&](std::size_t begin, std::size_t end) {
    Ranges::Sums part{};
    for (std::size_t first = begin; first < end; first += kDotBlock) {
      Vec4f r_z = Vec4f::Zero(), g_z = Vec4f::Zero();
      for (std::size_t i = first; i < std::min(first + kDotBlock, end); ++i) {
        r_z += r[i].cwiseProduct(z[i]);
        g_z += gradient_[i].cwiseProduct(z[i]);
      }
      part[0] += static_cast<double>(r_z.sum());
      part[1] += static_cast<double>(g_z.sum());
    }
    return part;
  });
  return {sums[0], sums[1]};
}

/// With c = C W r:  μ_c = S⁻¹ c but for what the volume's share of it changes, μ_v = g'·W r /
/// effective mass, and r·z is r·W r less what each row takes.
double ConstraintProjection::hold_rows(const Sums& sums, std::vector<Vec4f>& r,
                                       std::vector<Vec4f>& z) {
  double r_z = sums.r_z;
  if (!rows_.empty()) {
    const Eigen::VectorXd row_speeds = times_rows(z), mu = factor_.solve(row_speeds);
    subtract_rows(mu, r, z);
    r_z -= mu.dot(row_speeds);
    all_mu_ += mu;
  }
  volume_mu_ = volume_inverse_mass_ > 0 ? sums.g_z / volume_inverse_mass_ : 0;
  all_volume_mu_ += volume_mu_;
  return r_z - volume_mu_ * sums.g_z;
}

void ConstraintProjection::turn(double kept, const std::vector<Vec4f>& z,
                                AlignedVector<WideNode>& p) const {
  const auto factor = static_cast<float>(kept), mu = static_cast<float>(volume_mu_);
  ranges_.each(z.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      p[i].vector = z[i] - mu * volume_response_[i] + factor * p[i].vector;
    }
  });
}

void ConstraintProjection::take_impulses(std::span<ContactRow> contacts, double& volume_impulse,
                                         std::vector<Vec4f>& r) {
  if (volume_inverse_mass_ > 0 && !rows_.empty()) all_mu_ -= all_volume_mu_ * volume_shares_;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    // μ is what r had along the row; the contact's impulse takes it away.
    contacts[rows_[k].contact].normal_impulse += all_mu_[static_cast<Eigen::Index>(k)];
  }
  add(-volume_mu_, gradient_, r);
  volume_mu_ = 0;
  volume_impulse += all_volume_mu_;
}

Eigen::VectorXd ConstraintProjection::times_rows(const std::vector<Vec4f>& v) const {
  Eigen::VectorXd out(static_cast<Eigen::Index>(rows_.size()));
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      if (rows_[r].weights[k] == 0) continue;
      sum += rows_[r].weights[k] * v[rows_[r].nodes[k]].head<3>().cast<double>();
    }
    out[static_cast<Eigen::Index>(r)] = rows_[r].normal.dot(sum);
  }
  return out;
}

void ConstraintProjection::subtract_rows(const Eigen::VectorXd& mu, std::vector<Vec4f>& r,
                                         std::vector<Vec4f>& z) const {
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const Row& row = rows_[k];
    const double row_mu = mu[static_cast<Eigen::Index>(k)];
    for (int n = 0; n < 3; ++n) {
      if (row.weights[n] == 0) continue;
      const Vec4f impulse = wide((row.weights[n] * row_mu) * row.normal);
      r[row.nodes[n]] -= impulse;
      z[row.nodes[n]] -= apply_inverse_mass(row.nodes[n], impulse);
    }
  }
}

}  // namespace palpate::deformation
