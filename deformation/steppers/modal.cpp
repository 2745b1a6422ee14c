#include "deformation/steppers/modal.h"

#include <algorithm>
#include <cmath>

#include "deformation/contact/gauss_seidel.h"
#include "deformation/steppers/modal_analysis.h"
#include "deformation/steppers/newton_backward_euler.h"

namespace palpate::deformation {
namespace {

/// What of ω² is lost in the iterations that find the modes, as part of the highest.
constexpr double kFrequencyNoise = 1e-7;
constexpr int kMaxSweeps = 200;

using ConstCoordinates = Eigen::Map<const Eigen::VectorXd>;

ConstCoordinates coordinates_of(const std::vector<Vec3>& vectors) {
  return {vectors.front().data(), static_cast<Eigen::Index>(3 * vectors.size())};
}

/// ä + damping ȧ + ω² a = load, exactly, for h [s].
void propagate(double h, double frequency, double damping, double load, double& a, double& rate) {
  if (frequency == 0) {
    const double dh = damping * h, decay = std::exp(-dh);
    const double once = dh < 1e-4 ? h * (1 - dh / 2) : -std::expm1(-dh) / damping;
    const double twice = dh < 1e-4 ? h * h * (0.5 - dh / 6) : (h - once) / damping;
    a += once * rate + twice * load;
    rate = decay * rate + once * load;
    return;
  }
  const double decay = damping / 2, square = frequency * frequency - decay * decay;
  const double swing = std::sqrt(std::abs(square));
  double c = 1, s = h;  // cos and sin/swing, or cosh and sinh/swing
  if (swing * h > 1e-6) {
    c = square > 0 ? std::cos(swing * h) : std::cosh(swing * h);
    s = (square > 0 ? std::sin(swing * h) : std::sinh(swing * h)) / swing;
  }
  const double kept = std::exp(-decay * h), middle = load / (frequency * frequency);
  const double b = a - middle, v = rate;
  a = middle + kept * (c * b + s * (v + decay * b));
  rate = kept * (c * v - s * (frequency * frequency * b + decay * v));
}

}  // namespace

Modal::Modal(const OrganModel& model, std::size_t count, double damping_ratio) : model_(model) {
  find_modes(count);
  damping_ = (2 * damping_ratio * frequencies_).array() + model.drag;
  load_ = momenta_.transpose() *
          model.gravity.replicate(static_cast<Eigen::Index>(model.node_count()), 1);
}

void Modal::find_modes(std::size_t count) {
  const auto solid = quadratic_solid(model_);
  const std::size_t rigid = model_.fixed_nodes.empty() ? 6 : 0;
  const std::size_t free_coordinates = 3 * (model_.node_count() - model_.fixed_nodes.size());
  const std::size_t wanted = rigid + std::min(count, free_coordinates / 4);
  const auto found = modal_analysis(solid, dirichlet_dofs(model_), wanted);
  modes_ = found.modes;
  momenta_ = found.momenta;
  frequencies_ = Eigen::Map<const Eigen::VectorXd>(found.angular_frequencies.data(),
                                                   static_cast<Eigen::Index>(wanted));
  const Eigen::VectorXd volumes = corner_volumes(solid.mesh());
  pressures_ = -(found.pressures.transpose() * volumes) / volumes.sum();
  const double noise = std::sqrt(kFrequencyNoise) * frequencies_.maxCoeff();
  frequencies_ = (frequencies_.array() > noise).select(frequencies_, 0);
  for (Eigen::Index k = 0; k < frequencies_.size(); ++k) {
    if (frequencies_[k] == 0) pressures_[k] = 0;
  }
}

StepReport Modal::step(double h, std::span<ContactRow> rows, OrganState& state) {
  InternalState& internal = state.internal;
  if (!internal.goes_with(state.positions, state.velocities)) {
    internal.amplitudes = amplitudes(state);
    internal.rates = momenta_.transpose() * coordinates_of(state.velocities);
  }
  prepare(h, rows);
  if (!move_freely(h, rows, internal)) move_in_touch(h, rows, internal);
  write(state);
  return {};
}

/// Of the positions alone.
Eigen::VectorXd Modal::amplitudes(const OrganState& state) const {
  return momenta_.transpose() *
         (coordinates_of(state.positions) - coordinates_of(model_.rest_positions));
}

void Modal::write(OrganState& state) const {
  InternalState& internal = state.internal;
  Eigen::MatrixX2d both(internal.amplitudes.size(), 2);
  both << internal.amplitudes, internal.rates;
  const Eigen::MatrixX2d moved = modes_ * both;
  for (std::size_t i = 0; i < model_.node_count(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    state.positions[i] = model_.rest_positions[i] + moved.block<3, 1>(at, 0);
    state.velocities[i] = moved.block<3, 1>(at, 1);
  }
  state.pressure = pressures_.dot(internal.amplitudes);
  internal.positions = state.positions;
  internal.velocities = state.velocities;
}

void Modal::prepare(double h, std::span<const ContactRow> contacts) {
  inverse_mass_ = (1 + h * damping_.array() + (h * frequencies_).array().square()).inverse();
  rows_.resize(contacts.size());
  for (std::size_t r = 0; r < contacts.size(); ++r) {
    const ContactRow& contact = contacts[r];
    Row& row = rows_[r];
    row.motion.setZero(3, modes_.cols());
    for (int k = 0; k < 3; ++k) {
      const auto at = 3 * static_cast<Eigen::Index>(contact.nodes[static_cast<std::size_t>(k)]);
      if (contact.weights[k] != 0) row.motion += contact.weights[k] * modes_.middleRows<3>(at);
    }
    row.allowed = allowed_approach(contact, h);
    row.yielding = yielding_of(contact, h);
    const Eigen::VectorXd along = row.motion.transpose() * contact.normal;
    row.along = along.cwiseAbs2().dot(inverse_mass_);
    row.across = row.motion.colwise().squaredNorm().transpose().dot(inverse_mass_) - row.along;
  }
}

double Modal::separation(std::size_t row, const ContactRow& contact,
                         const Eigen::VectorXd& rates) const {
  return rows_[row].allowed -
         contact.normal.dot(rows_[row].motion * rates - contact.probe_velocity);
}

/// @returns false, and leaves the amplitudes, if a contact would be penetrated
bool Modal::move_freely(double h, std::span<ContactRow> contacts, InternalState& state) const {
  Eigen::VectorXd a = state.amplitudes, rates = state.rates;
  for (Eigen::Index k = 0; k < a.size(); ++k) {
    propagate(h, frequencies_[k], damping_[k], load_[k], a[k], rates[k]);
  }
  const Eigen::VectorXd mean = (a - state.amplitudes) / h;
  for (std::size_t r = 0; r < contacts.size(); ++r) {
    if (rows_[r].along > 0 && separation(r, contacts[r], mean) < 0) return false;
  }
  for (ContactRow& contact : contacts) {
    contact.normal_impulse = 0;
    contact.tangential_impulse.setZero();
  }
  state.amplitudes = a;
  state.rates = rates;
  return true;
}

/// Sweeps end when no contact velocity changes by more than 1e-9 m/s, or after 200.
void Modal::move_in_touch(double h, std::span<ContactRow> contacts, InternalState& state) const {
  const Eigen::VectorXd forces = load_ - frequencies_.cwiseAbs2().cwiseProduct(state.amplitudes);
  Eigen::VectorXd& rates = state.rates;
  rates = inverse_mass_.cwiseProduct(rates + h * forces);
  for (std::size_t r = 0; r < contacts.size(); ++r) {
    contacts[r].tangential_impulse.setZero();
    add_impulse(rows_[r], -contacts[r].normal_impulse * contacts[r].normal, rates);
  }
  double change = 1;
  for (int sweep = 0; sweep < kMaxSweeps && change > kContactVelocityTolerance; ++sweep) {
    change = 0;
    for (std::size_t r = 0; r < contacts.size(); ++r) {
      if (rows_[r].along > 0) change = std::max(change, relax(r, contacts[r], rates));
    }
  }
  state.amplitudes += h * rates;
}

void Modal::add_impulse(const Row& row, const Vec3& impulse, Eigen::VectorXd& rates) const {
  rates += inverse_mass_.cwiseProduct(row.motion.transpose() * impulse);
}

/// @returns the change of the contact's velocity [m/s]
double Modal::relax(std::size_t r, ContactRow& contact, Eigen::VectorXd& rates) const {
  const Row& row = rows_[r];
  const double pressed = press(contact, separation(r, contact, rates), 1 / row.along, row.yielding);
  if (pressed != 0) add_impulse(row, -pressed * contact.normal, rates);
  double change = std::abs(pressed) * row.along;
  if (contact.friction == 0 || row.across <= 0) return change;
  const Vec3 velocity = row.motion * rates - contact.probe_velocity;
  const Vec3 sliding = velocity - contact.normal * contact.normal.dot(velocity);
  Vec3 wanted = contact.tangential_impulse - sliding / row.across;
  const double most = contact.friction * contact.normal_impulse, size = wanted.norm();
  if (size > most) wanted *= most / size;
  const Vec3 rubbed = wanted - contact.tangential_impulse;
  contact.tangential_impulse = wanted;
  add_impulse(row, rubbed, rates);
  return std::max(change, rubbed.norm() * row.across);
}

Eigen::MatrixXd Modal::compliance(std::span<const ComplianceRow> rows,
                                  const PeriodSteps& steps) const {
  Eigen::MatrixXd motion =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()), modes_.cols());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const auto& [node, weight] : rows[r].weights) {
      motion.row(static_cast<Eigen::Index>(r)) +=
          weight * rows[r].axis.transpose() * modes_.middleRows<3>(3 * node);
    }
  }
  const double T = steps.period;
  const Eigen::ArrayXd answers = 1 / (1 / (T * T) + steps.moving() / T * damping_.array() +
                                      steps.displaced() * frequencies_.array().square());
  return motion * answers.matrix().asDiagonal() * motion.transpose();
}

double Modal::elastic_energy(const OrganState& state) {
  const InternalState& internal = state.internal;
  const bool known = internal.goes_with(state.positions, state.velocities);
  return frequencies_.cwiseProduct(known ? internal.amplitudes : amplitudes(state)).squaredNorm() /
         2;
}

}  // namespace palpate::deformation
