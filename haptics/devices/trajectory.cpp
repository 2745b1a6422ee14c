#include "haptics/devices/trajectory.h"

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"
#include "modules/core/rotation_vector.h"

namespace palpate::haptics {
namespace {

constexpr double kShortestReturn = 0.5;  ///< [s]
constexpr double kReturnSpeed = 0.05;    ///< [m/s]
constexpr double kReturnTurn = 1;        ///< [rad/s]

/// Fritsch–Butland slope at a knot between intervals of lengths `before`, `after` with secants
/// `rate_before`, `rate_after`: their weighted harmonic mean, 0 where they differ in sign.
Vec3 monotone_slope(double before, double after, const Vec3& rate_before, const Vec3& rate_after) {
  const double weight_before = before + 2 * after;
  const double weight_after = 2 * before + after;
  Vec3 slope = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const double a = rate_before[axis], b = rate_after[axis];
    if ((a > 0 && b > 0) || (a < 0 && b < 0)) {
      slope[axis] = (weight_before + weight_after) / (weight_before / a + weight_after / b);
    }
  }
  return slope;
}

/// Rotation from a to b in either's frame, per time [rad/s].
Vec3 turn_rate(const Quat& a, const Quat& b, double duration) {
  return vector_from_rotation(a.conjugate() * b) / duration;
}

double return_duration(const Pose& last, const Pose& first) {
  const double distance = (first.position - last.position).norm();
  const double angle = vector_from_rotation(last.rotation.conjugate() * first.rotation).norm();
  return std::max({kShortestReturn, distance / kReturnSpeed, angle / kReturnTurn});
}

}  // namespace

struct Trajectory::Interval {
  double length;
  Vec3 velocity, turn;
};

struct Trajectory::Slopes {
  Vec3 velocity = Vec3::Zero();               ///< in the frame of the poses [m/s]
  Vec3 angular_velocity_body = Vec3::Zero();  ///< in the body's frame [rad/s]
};

Trajectory::Trajectory(std::vector<TimedPose> samples, bool loop)
    : samples_(std::move(samples)), loop_(loop) {
  PALPATE_DEMAND(samples_.size() >= 2);
  const double first = samples_.front().time;
  for (TimedPose& sample : samples_) sample.time -= first;
  end_ = duration();
  if (loop_) end_ += return_duration(samples_.back().pose, samples_.front().pose);
}

TimedPose Trajectory::knot(std::size_t i) const {
  return i < samples_.size() ? samples_[i] : TimedPose{end_, samples_.front().pose};
}

Trajectory::Interval Trajectory::interval(std::size_t i) const {
  const TimedPose a = knot(i), b = knot(i + 1);
  const double length = b.time - a.time;
  return {length, (b.pose.position - a.pose.position) / length,
          turn_rate(a.pose.rotation, b.pose.rotation, length)};
}

Trajectory::Slopes Trajectory::slopes_at(std::size_t knot) const {
  const std::size_t last = knot_count() - 1;
  const bool at_an_end = knot == 0 || knot == last;
  if (at_an_end && !loop_) return {};  // the pose is held, at rest, before and after
  const Interval before = interval(at_an_end ? last - 1 : knot - 1);
  const Interval after = interval(at_an_end ? 0 : knot);
  return {monotone_slope(before.length, after.length, before.velocity, after.velocity),
          monotone_slope(before.length, after.length, before.turn, after.turn)};
}

DeviceSample Trajectory::at(double time) const {
  if (loop_) time -= end_ * std::floor(time / end_);
  time = std::clamp(time, 0.0, end_);
  const auto next = std::upper_bound(samples_.begin() + 1, samples_.end() - (loop_ ? 0 : 1), time,
                                     [](double t, const TimedPose& s) { return t < s.time; });
  const auto after = static_cast<std::size_t>(next - samples_.begin());
  const TimedPose a = knot(after - 1), b = knot(after);
  const Slopes slope_a = slopes_at(after - 1), slope_b = slopes_at(after);
  const double h = b.time - a.time;
  const double s = (time - a.time) / h, r = 1 - s;

  DeviceSample sample;
  const Vec3 step = b.pose.position - a.pose.position;
  sample.pose.position = a.pose.position + s * s * (3 - 2 * s) * step +
                         h * s * r * (r * slope_a.velocity - s * slope_b.velocity);
  sample.twist.linear = 6 * s * r / h * step + r * (1 - 3 * s) * slope_a.velocity +
                        s * (3 * s - 2) * slope_b.velocity;

  // q = q_a exp(β₁w₁) exp(β₂w₂) exp(β₃w₃) with the cumulative cubic Bernstein functions
  // β₁ = 1 − r³, β₂ = s²(3 − 2s), β₃ = s³. Its rate in the body's frame is the sum of the three
  // β̇ᵢwᵢ, each turned into the frame behind the factors on its right.
  const Vec3 w1 = h / 3 * slope_a.angular_velocity_body;
  const Vec3 w3 = h / 3 * slope_b.angular_velocity_body;
  const Vec3 w2 = vector_from_rotation(rotation_from_vector(-w1) * a.pose.rotation.conjugate() *
                                       b.pose.rotation * rotation_from_vector(-w3));
  const Quat first = rotation_from_vector((1 - r * r * r) * w1);
  const Quat second = rotation_from_vector(s * s * (3 - 2 * s) * w2);
  const Quat third = rotation_from_vector(s * s * s * w3);
  sample.pose.rotation = (a.pose.rotation * first * second * third).normalized();
  const Vec3 rate_behind_first = 3 * r * r * w1;
  const Vec3 rate_behind_second = second.conjugate() * rate_behind_first + 6 * s * r * w2;
  const Vec3 rate_body = third.conjugate() * rate_behind_second + 3 * s * s * w3;
  sample.twist.angular = sample.pose.rotation * (rate_body / h);
  return sample;
}

}  // namespace palpate::haptics
