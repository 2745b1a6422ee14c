#include "studies/stability/predicted_step.h"

#include <cmath>
#include <random>

#include "deformation/volume/volume_constraint.h"

namespace palpate::stability {
namespace {

using deformation::OrganModel;
using Vectors = std::vector<Vec3>;

constexpr int kRounds = 8;            // of h
constexpr int kIterations = 4000;     // of power iteration per round, at most
constexpr double kTolerance = 1e-10;  // change of the eigenvalue in one iteration, of it

double dot(const Vectors& a, const Vectors& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

/// M⁻¹(a K + b C) and its parts, matrix-free.
class Operator {
 public:
  Operator(const OrganModel& model, const Vectors& positions, const Contents& contents)
      : model_(model), positions_(positions), contents_(contents) {
    deformation::evaluate_volume(model, positions, volume_);
  }

  /// out = (a K + b C) v
  void apply(const Vectors& v, double a, double b, Vectors& out) const {
    out.assign(v.size(), Vec3::Zero());
    const auto& springs = model_.network().springs;
    for (std::size_t s = 0; s < springs.size(); ++s) {
      const auto& spring = springs[s];
      const Vec3 along = positions_[spring.node_b] - positions_[spring.node_a];
      const double length = along.norm();
      const Vec3 u = along / length, change = v[spring.node_b] - v[spring.node_a];
      const double tension = a * spring.stiffness * (1 - spring.rest_length / length);
      const double axial = a * spring.stiffness + b * model_.network().damping[s] - tension;
      const Vec3 force = axial * u.dot(change) * u + tension * change;
      out[spring.node_a] -= force;
      out[spring.node_b] += force;
    }
    const double pressure = a * contents_.stiffness * volume_rate(v);
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (i < volume_.gradient.size()) out[i] += pressure * volume_.gradient[i];
      out[i] += b * model_.drag * model_.masses[i] * v[i];
    }
  }

  /// Masses away, fixed nodes at rest, and no motion along the volume if that is kept.
  void finish(Vectors& w) const {
    for (std::size_t i = 0; i < w.size(); ++i) w[i] *= model_.inverse_masses[i];
    if (!contents_.kept) return;
    const double share = volume_rate(w) / volume_.denominator;
    for (std::size_t i = 0; i < volume_.gradient.size(); ++i) {
      w[i] -= share * model_.inverse_masses[i] * volume_.gradient[i];
    }
  }

  double mass_norm(const Vectors& v) const {
    double sum = 0;
    for (std::size_t i = 0; i < v.size(); ++i) sum += model_.masses[i] * v[i].squaredNorm();
    return std::sqrt(sum);
  }

 private:
  double volume_rate(const Vectors& v) const {
    double rate = 0;
    for (std::size_t i = 0; i < volume_.gradient.size(); ++i) rate += volume_.gradient[i].dot(v[i]);
    return rate;
  }

  const OrganModel& model_;
  const Vectors& positions_;
  Contents contents_;
  deformation::VolumeGradient volume_;
};

/// Turns `mode` towards the eigenvector of the largest eigenvalue.
void iterate(const Operator& of, double a, double b, Vectors& mode) {
  Vectors next;
  double eigenvalue = 0;
  for (int k = 0; k < kIterations; ++k) {
    of.apply(mode, a, b, next);
    of.finish(next);
    const double norm = of.mass_norm(next), change = std::abs(norm - eigenvalue);
    eigenvalue = norm;
    for (std::size_t i = 0; i < next.size(); ++i) mode[i] = next[i] / norm;
    if (change < kTolerance * norm) break;
  }
}

}  // namespace

double predicted_step(const OrganModel& model, const Vectors& positions, const Contents& contents) {
  const Operator of(model, positions, contents);
  std::mt19937 random(1);
  Vectors mode(model.node_count()), product;
  for (Vec3& v : mode) {
    for (int axis = 0; axis < 3; ++axis) v[axis] = random() / double(random.max()) - 0.5;
  }
  for (std::size_t i = 0; i < mode.size(); ++i) mode[i] *= model.masses[i];
  of.finish(mode);
  const double norm = of.mass_norm(mode);
  for (Vec3& v : mode) v /= norm;

  double h = deformation::stable_step_bound(model);
  for (int round = 0; round < kRounds; ++round) {
    iterate(of, h * h, 2 * h, mode);
    of.apply(mode, 1, 0, product);
    const double squared = dot(mode, product);  // uᵀK u with uᵀM u = 1
    of.apply(mode, 0, 1, product);
    const double damping = dot(mode, product);
    const double next = (std::sqrt(damping * damping + 4 * squared) - damping) / squared;
    const bool done = std::abs(next - h) < 1e-5 * h;
    h = next;
    if (done) break;
  }
  return h;
}

}  // namespace palpate::stability
