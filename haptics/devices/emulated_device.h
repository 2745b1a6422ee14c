// A haptic device and the hand that holds it, to test with: what a real one does to the loop, by
// numbers. One body, moved in translation, or along one axis; its orientation stays.
//
//   (m + m_h) ẍ = f_motor + push + k_h (x_t − x) + b_h (ẋ_t − ẋ) − b ẋ
//
// m, b of the device; m_h, b_h, k_h of the hand, which wants to be at x_t (Hogan 1985: a hand is an
// impedance about an equilibrium that moves). f_motor is what the device was told, as far as its
// motors go, held for a cycle of its own loop of rate 1/T: the body is moved exactly over a cycle.
// Positions are read in whole encoder steps. A reading is on its way for n cycles and a force for n
// more, so with a haptic loop on the same grid a force is T/2 + 2 n T behind the position that it
// is for, in the mean.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "haptics/devices/device.h"
#include "haptics/devices/scripted_device.h"

namespace palpate::haptics {

class EmulatedDevice final : public Device {
 public:
  /// Velocity is told as the difference of readings this many cycles apart.
  static constexpr std::size_t kVelocityCycles = 4;

  explicit EmulatedDevice(const scene::EmulatedDevice& config);

  /// Its own time begins with the first read() after construction or reset().
  DeviceSample read(double time) override;
  /// The motors get the force at the first cycle that begins no earlier than the last read(), and
  /// its transport later.
  void feel(const RenderedForce& force) override;
  void reset() override;

  // The body itself, at the beginning of the present cycle; unknown to its encoders.
  const Vec3& position() const { return position_; }        ///< [m]
  const Vec3& velocity() const { return velocity_; }        ///< [m/s]
  const Vec3& motor_force() const { return motor_force_; }  ///< [N]
  double period() const { return period_; }                 ///< T [s]

  void exchange(StateArchive& archive) override {
    archive(begin_, read_at_, cycle_, position_, velocity_, motor_force_);
    for (Arrival& arrival : arrivals_) archive(arrival);
    for (Vec3& reading : readings_) archive(reading);
  }

 private:
  struct Arrival {
    std::int64_t cycle = -1;
    Vec3 force = Vec3::Zero();
    void exchange(StateArchive& archive) { archive(cycle, force); }
  };
  Arrival& arrival(std::int64_t cycle);
  Vec3& reading(std::int64_t cycle);
  void step();

  scene::EmulatedDevice config_;
  double period_, max_force_, encoder_step_;
  std::int64_t transport_;  ///< n
  ScriptedDevice target_;   ///< x_t
  Eigen::Matrix2d free_;    ///< of (x, ẋ) over a cycle
  Eigen::Vector2d driven_;  ///< by a force held over it [m/N, m/(N·s)]

  std::optional<double> begin_;  ///< of its time, by that of read() [s]
  double read_at_ = 0;           ///< in cycles
  std::int64_t cycle_ = 0;
  Vec3 position_, velocity_ = Vec3::Zero(), motor_force_ = Vec3::Zero();
  std::vector<Arrival> arrivals_;  ///< forces on their way, by cycle
  std::vector<Vec3> readings_;     ///< the newest ones, by cycle
};

}  // namespace palpate::haptics
