#include "deformation/contact/patch_compliance.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace palpate::deformation {
namespace {

/// Nodes that a law's compliance is taken from, each by itself. Nearly incompressible tissue
/// reaches further.
constexpr std::size_t kPatchOfSprings = 32, kPatchOfSolid = 110;

SpringShares shares_of(const PeriodSteps& steps, double drag) {
  const double T = steps.period;
  return {.mass = (1 + T * drag * steps.moving()) / (T * T),
          .damping = steps.moving() / T,
          .stiffness = steps.displaced()};
}

}  // namespace

PatchCompliance::PatchCompliance(const OrganModel& model, Neighbours neighbours, std::size_t nodes,
                                 ChunkRunner* runner)
    : model_(model), neighbours_(std::move(neighbours)), nodes_(nodes) {
  // When a probe first touches would be too late: a fine wall's takes more than a period.
  if (!model.is_solid()) far_.emplace(model, runner);
}

void PatchCompliance::begin_with(const PatchCompliance& before,
                                 const SolidAnswers::Carry& carried) {
  solid_.reset();
  if (before.solid_) solid_.emplace(model_).begin_with(*before.solid_, carried);
}

void PatchCompliance::exchange(StateArchive& archive) {
  bool has_solid = solid_.has_value();
  archive(has_solid);
  if (!has_solid) return solid_.reset();
  if (!solid_) solid_.emplace(model_);
  archive(*solid_);
}

Vec3 PatchCompliance::find_touched(const std::vector<Vec3>& positions,
                                   std::span<const ComplianceRow> rows) {
  touched_.clear();
  Vec3 centre = Vec3::Zero();
  double total = 0;
  for (const ComplianceRow& row : rows) {
    for (const auto& [node, weight] : row.weights) {
      if (weight == 0) continue;
      touched_.push_back(node);
      centre += weight * positions[node];
      total += weight;
    }
  }
  std::ranges::sort(touched_);
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  return centre / total;
}

std::size_t PatchCompliance::near_nodes(const StepMatrix& last) const {
  if (!model_.is_solid()) {
    return std::clamp(touched_.size(), nodes_, std::max(nodes_, kMostNearInSprings));
  }
  return last ? std::clamp(touched_.size(), std::min(kNearInSolid, nodes_), nodes_) : nodes_;
}

Eigen::MatrixXd PatchCompliance::solve(const std::vector<Vec3>& positions,
                                       std::span<const ComplianceRow> rows,
                                       const PeriodSteps& steps, std::span<const Vec3> gradient,
                                       const AddStiffness& add_stiffness, const StepMatrix& last) {
  const SpringShares shares = shares_of(steps, model_.drag);
  if (!(shares.stiffness > 0)) return answers_of_masses(rows, gradient) / shares.mass;
  const Vec3 centre = find_touched(positions, rows);
  const std::size_t most = near_nodes(last);
  grow_patch(model_, neighbours_, positions, touched_, centre, most, patch_);
  const auto size = static_cast<Eigen::Index>(3 * patch_.nodes.size());
  pressed_.stiffness.setZero(size, size);
  pressed_.damping.setZero(size, size);
  add_stiffness(patch_, pressed_.stiffness, pressed_.damping);
  Eigen::MatrixXf A = static_cast<float>(shares.stiffness) * pressed_.stiffness +
                      static_cast<float>(shares.damping) * pressed_.damping;
  double mass = 0;
  const double springs = A.trace();
  for (const std::uint32_t node : patch_.nodes) {
    const double own = shares.mass * model_.masses[node];
    A.diagonal().segment<3>(3 * patch_.place(node)).array() += static_cast<float>(own);
    mass += 3 * own;
  }
  const Eigen::Index far = extend(positions, centre, springs / mass, rows, shares, last, A);
  const Eigen::MatrixXd evenly = answers(A, far, shares.mass, rows, gradient);
  const bool is_explicit = !model_.is_solid() && !steps.implicit && steps.count > 1;
  if (!is_explicit || far > 0) return evenly;
  return shortfall(evenly, rows, steps, gradient) * evenly;
}

Eigen::MatrixXd PatchCompliance::answers_of_masses(std::span<const ComplianceRow> rows,
                                                   std::span<const Vec3> gradient) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd answers = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(count);
  pushes_.clear();
  for (Eigen::Index r = 0; r < count; ++r) {
    const ComplianceRow& row = rows[static_cast<std::size_t>(r)];
    for (const auto& [node, weight] : row.weights) {
      pushes_.push_back({node, r, weight * row.axis});
      if (node >= gradient.size()) continue;
      volume[r] += model_.inverse_masses[node] * gradient[node].dot(pushes_.back().push);
    }
  }
  // By nodes, of one as they stand: numbers sort faster than pushes.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> places;
  for (std::uint32_t i = 0; i < pushes_.size(); ++i) places.push_back({pushes_[i].node, i});
  std::ranges::sort(places);
  for (auto first = places.begin(); first != places.end();) {
    const auto last =
        std::find_if(first, places.end(), [&](const auto& p) { return p.first != first->first; });
    const double inverse_mass = model_.inverse_masses[first->first];
    for (auto i = first; i != last; ++i) {
      const Push& a = pushes_[i->second];
      for (auto k = first; k != last; ++k) {
        const Push& b = pushes_[k->second];
        answers(a.row, b.row) += inverse_mass * a.push.dot(b.push);
      }
    }
    first = last;
  }
  double inverse_mass = 0;  // gᵀM⁻¹g
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    inverse_mass += gradient[i].squaredNorm() * model_.inverse_masses[i];
  }
  if (inverse_mass > 0) answers -= volume * volume.transpose() / inverse_mass;
  return answers;
}

Eigen::Index PatchCompliance::extend(const std::vector<Vec3>& positions, const Vec3& centre,
                                     double stiffness, std::span<const ComplianceRow> rows,
                                     const SpringShares& shares, const StepMatrix& last,
                                     Eigen::MatrixXf& A) {
  const Eigen::Index size = A.rows();
  const auto take = [&](const Eigen::MatrixXf& near_block, const Eigen::Matrix3f& own_block) {
    // Nothing goes along, or a bad state's matrix: as if held.
    if (own_block.llt().info() != Eigen::Success) return Eigen::Index{0};
    A.conservativeResize(size + 3, size + 3);
    A.bottomLeftCorner(3, size) = near_block.transpose();
    A.bottomRightCorner(3, 3) = own_block;
    return Eigen::Index{3};
  };
  if (last && patch_.nodes.size() + model_.fixed_nodes.size() < model_.node_count()) {
    if (!solid_) solid_.emplace(model_);
    solid_->find(last, shares, patch_, A, rows);
    return take(solid_->near_block(), solid_->own_block());
  }
  const std::size_t reach =
      std::min(kMostInReach, nodes_in_reach(touched_.size(), edges_in_reach(stiffness)));
  if (model_.is_solid() || reach <= 2 * nodes_) return 0;
  far_->find(positions, neighbours_, touched_, centre, patch_.nodes.size(), reach, rows, shares);
  return take(far_->near_block(), far_->own_block());
}

Eigen::Vector3f PatchCompliance::far_load(std::uint32_t node, const Vec3& push) const {
  return model_.is_solid() ? solid_->load(node, push) : far_->load(node, push);
}

Mat3 PatchCompliance::alone(std::uint32_t node, Eigen::Index far, double mass_share) const {
  if (far > 0 && model_.is_solid()) return solid_->alone(node);
  const Mat3* const own = far > 0 ? far_->alone(node) : nullptr;
  if (own != nullptr) return *own;
  return model_.inverse_masses[node] / mass_share * Mat3::Identity();
}

double PatchCompliance::shortfall(const Eigen::MatrixXd& evenly,
                                  std::span<const ComplianceRow> rows, const PeriodSteps& steps,
                                  std::span<const Vec3> gradient) {
  Eigen::VectorXd press(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    press[static_cast<Eigen::Index>(r)] = rows[r].force;
  }
  if (press.isZero(0)) press[0] = 1;
  press.normalize();
  const auto size = static_cast<Eigen::Index>(3 * patch_.nodes.size());
  pressed_.push.setZero(size);
  pressed_.volume.setZero(size);
  pressed_.masses.resize(size);
  pressed_.drag = model_.drag;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const auto& [node, weight] : rows[r].weights) {
      const int place = patch_.place(node);
      if (place < 0) return 1;  // a touch of more nodes, or a fixed one, which answers alone
      pressed_.push.segment<3>(3 * place) +=
          press[static_cast<Eigen::Index>(r)] * weight * rows[r].axis;
    }
  }
  for (const std::uint32_t node : patch_.nodes) {
    pressed_.masses.segment<3>(3 * patch_.place(node)).setConstant(model_.masses[node]);
  }
  pressed_.volume_beyond = 0;
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    const int place = patch_.place(static_cast<std::uint32_t>(i));
    if (place >= 0) {
      pressed_.volume.segment<3>(3 * place) = gradient[i];
    } else {
      pressed_.volume_beyond += gradient[i].squaredNorm() * model_.inverse_masses[i];
    }
  }
  const double found = even_press_compliance(pressed_, steps.period, steps.count);
  const double expected = press.dot(evenly * press);
  return found > 0 && expected > 0 ? found / expected : 1;
}

Eigen::MatrixXd PatchCompliance::answers(const Eigen::MatrixXf& A, Eigen::Index far,
                                         double mass_share, std::span<const ComplianceRow> rows,
                                         std::span<const Vec3> gradient) const {
  const auto count = static_cast<Eigen::Index>(rows.size());
  // A column a row of C, and one for the volume.
  Eigen::MatrixXf loads = Eigen::MatrixXf::Zero(A.rows(), count + 1);
  for (const std::uint32_t node : patch_.nodes) {
    if (node >= gradient.size()) continue;
    loads.col(count).segment<3>(3 * patch_.place(node)) = gradient[node].cast<float>();
  }
  Eigen::MatrixXd alone = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const ComplianceRow& row = rows[static_cast<std::size_t>(r)];
    for (const auto& [node, weight] : row.weights) {
      const int place = patch_.place(node);
      if (place >= 0) {
        loads.col(r).segment<3>(3 * place) += (weight * row.axis).cast<float>();
      } else {
        alone(r, r) +=
            weight * weight * row.axis.dot(this->alone(node, far, mass_share) * row.axis);
      }
      if (far > 0) loads.col(r).tail<3>() += far_load(node, weight * row.axis);
    }
  }
  const Eigen::LLT<Eigen::MatrixXf> factor(A);
  if (factor.info() != Eigen::Success) {
    // What goes along beyond may be so little that float sees nothing of it: as if held.
    const Eigen::Index near = A.rows() - far;
    if (far > 0) return answers(A.topLeftCorner(near, near), 0, mass_share, rows, gradient);
    return Eigen::MatrixXd::Zero(count, count);  // no law from a bad state
  }
  // W = (L⁻¹Cᵀ)ᵀ(L⁻¹Cᵀ): symmetric and positive however it is rounded.
  const Eigen::MatrixXd half = factor.matrixL().solve(loads).cast<double>();
  Eigen::MatrixXd answers = half.leftCols(count).transpose() * half.leftCols(count) + alone;
  if (gradient.empty()) return answers;

  double inverse_mass = half.col(count).squaredNorm();  // gᵀA⁻¹g
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    if (patch_.place(static_cast<std::uint32_t>(i)) < 0) {
      inverse_mass += gradient[i].squaredNorm() * model_.inverse_masses[i] / mass_share;
    }
  }
  if (!(inverse_mass > 0)) return answers;
  const Eigen::VectorXd shares_of_volume = half.leftCols(count).transpose() * half.col(count);
  return answers - shares_of_volume * shares_of_volume.transpose() / inverse_mass;
}

std::unique_ptr<PatchCompliance> make_compliance(const OrganModel& model, ChunkRunner* runner) {
  std::vector<geometry::Tetrahedron> tetrahedra;
  if (model.is_solid()) tetrahedra = model.mesh().tetrahedra;
  const std::size_t nodes = model.is_solid() ? kPatchOfSolid : kPatchOfSprings;
  return std::make_unique<PatchCompliance>(model, Neighbours(model, tetrahedra), nodes, runner);
}

}  // namespace palpate::deformation
