#include "haptics/devices/emulated_device.h"

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"
#include "modules/core/vector_checks.h"

namespace palpate::haptics {
namespace {

/// Times within this part of a cycle are on its grid.
constexpr double kOnGrid = 1e-6;

/// Sizes of a class of devices, not of any unit: peak force and encoder step as the makers' data
/// sheets of Touch (3D Systems) and omega.3 (Force Dimension) give them; mass at the grip, held
/// lightly, and damping of the order that is measured of such devices.
struct Preset {
  double mass, damping, max_force, encoder_step;  // [kg], [N·s/m], [N], [m]
};
Preset preset(scene::EmulatedDevice::Kind kind) {
  using Kind = scene::EmulatedDevice::Kind;
  return kind == Kind::kOmega ? Preset{0.2, 0.2, 12, 1e-5} : Preset{0.1, 0.2, 3.3, 5.5e-5};
}

/// exp(m), by its series for m/2^s, squared s times.
Eigen::Matrix3d exponential(Eigen::Matrix3d m) {
  int squarings = 0;
  for (; m.cwiseAbs().maxCoeff() > 0.1; ++squarings) m /= 2;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity(), term = sum;
  for (int i = 1; i <= 12; ++i) {  // 0.3^12/12! is 1e-15
    term = term * m / i;
    sum += term;
  }
  for (; squarings > 0; --squarings) sum = sum * sum;
  return sum;
}

scene::ScriptedDevice target_of(const scene::EmulatedDevice& device) {
  return {device.start, device.rotation, device.hand.moves};
}

}  // namespace

EmulatedDevice::EmulatedDevice(const scene::EmulatedDevice& config)
    : config_(config), period_(1 / config.rate), target_(target_of(config)) {
  const Preset of_kind = preset(config.kind);
  max_force_ = config.max_force.value_or(of_kind.max_force);
  encoder_step_ = config.encoder_step.value_or(of_kind.encoder_step);
  transport_ = std::llround(config.transport_delay * config.rate);
  config_.rotation.normalize();
  if (config_.axis) config_.axis->normalize();

  const scene::EmulatedDevice::Hand& hand = config.hand;
  const double mass = config.mass.value_or(of_kind.mass) + hand.mass;
  const double damping = config.damping.value_or(of_kind.damping) + hand.damping;
  PALPATE_DEMAND(mass > 0);
  Eigen::Matrix3d rate;  // of (x, ẋ, f)
  rate << 0, 1, 0, -hand.stiffness / mass, -damping / mass, 1 / mass, 0, 0, 0;
  const Eigen::Matrix3d over_cycle = exponential(period_ * rate);
  free_ = over_cycle.topLeftCorner<2, 2>();
  driven_ = over_cycle.topRightCorner<2, 1>();

  const auto n = static_cast<std::size_t>(transport_);
  arrivals_.resize(n + 2);
  readings_.resize(n + 1 + kVelocityCycles);
  reset();
}

void EmulatedDevice::reset() {
  begin_.reset();
  cycle_ = 0;
  position_ = config_.start;
  velocity_.setZero();
  motor_force_.setZero();
  std::fill(arrivals_.begin(), arrivals_.end(), Arrival{});
  std::fill(readings_.begin(), readings_.end(), config_.start);
}

EmulatedDevice::Arrival& EmulatedDevice::arrival(std::int64_t cycle) {
  return arrivals_[static_cast<std::size_t>(cycle) % arrivals_.size()];
}

/// Of a cycle before the first: the start.
Vec3& EmulatedDevice::reading(std::int64_t cycle) {
  const auto size = static_cast<std::int64_t>(readings_.size());
  return readings_[static_cast<std::size_t>(cycle + size) % readings_.size()];
}

/// One cycle: the newest force that has arrived is held, the target is taken at the middle.
void EmulatedDevice::step() {
  if (arrival(cycle_).cycle == cycle_) motor_force_ = arrival(cycle_).force;
  const DeviceSample target = target_.read(period_ * (static_cast<double>(cycle_) + 0.5));
  const Vec3 to_target = target.pose.position - config_.start;
  const scene::EmulatedDevice::Hand& hand = config_.hand;
  Vec3 force =
      motor_force_ + hand.push + hand.stiffness * to_target + hand.damping * target.twist.linear;
  if (config_.axis) force = config_.axis->dot(force) * *config_.axis;  // the rail bears the rest
  const Vec3 moved = position_ - config_.start;
  position_ = config_.start + free_(0, 0) * moved + free_(0, 1) * velocity_ + driven_[0] * force;
  velocity_ = free_(1, 0) * moved + free_(1, 1) * velocity_ + driven_[1] * force;

  ++cycle_;
  const Vec3 from_start = position_ - config_.start;
  Vec3& read = reading(cycle_) = position_;
  if (encoder_step_ > 0) {
    read = config_.start + encoder_step_ * (from_start / encoder_step_).array().round().matrix();
  }
}

DeviceSample EmulatedDevice::read(double time) {
  if (!begin_) begin_ = time;
  read_at_ = std::max(0.0, (time - *begin_) / period_);
  const auto now = static_cast<std::int64_t>(read_at_ + kOnGrid);
  while (cycle_ < now) step();

  DeviceSample sample;
  const std::int64_t sent = cycle_ - transport_;
  const Vec3 before = reading(sent - static_cast<std::int64_t>(kVelocityCycles));
  sample.pose = {reading(sent), config_.rotation};
  sample.twist.linear = (sample.pose.position - before) / (double(kVelocityCycles) * period_);
  sample.delay = 2 * static_cast<double>(transport_) * period_;
  return sample;
}

void EmulatedDevice::feel(const RenderedForce& force) {
  const auto sent = static_cast<std::int64_t>(std::ceil(read_at_ - kOnGrid));
  const std::int64_t arrives = sent + transport_;
  arrival(arrives) = {arrives, clamp_length(force.force, max_force_)};
}

}  // namespace palpate::haptics
