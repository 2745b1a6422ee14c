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

Trajectory::Trajectory(const std::vector<TimedPose>& samples, bool loop) : loop_(loop) {
  PALPATE_DEMAND(samples.size() >= 2);
  knots_.reserve(samples.size() + 1);
  for (const TimedPose& sample : samples) {
    knots_.push_back({.time = sample.time - samples.front().time, .pose = sample.pose});
  }
  last_sample_time_ = knots_.back().time;
  if (loop_) {
    const double duration = return_duration(knots_.back().pose, knots_.front().pose);
    knots_.push_back({.time = last_sample_time_ + duration, .pose = knots_.front().pose});
  }
  set_slopes();
}

void Trajectory::set_slopes() {
  struct Interval {
    double length;
    Vec3 velocity, turn;
  };
  const auto interval = [this](std::size_t i) {
    const Knot &a = knots_[i], &b = knots_[i + 1];
    const double length = b.time - a.time;
    return Interval{length, (b.pose.position - a.pose.position) / length,
                    turn_rate(a.pose.rotation, b.pose.rotation, length)};
  };
  const auto join = [](Knot& knot, const Interval& before, const Interval& after) {
    knot.velocity = monotone_slope(before.length, after.length, before.velocity, after.velocity);
    knot.angular_velocity_body =
        monotone_slope(before.length, after.length, before.turn, after.turn);
  };
  for (std::size_t i = 1; i + 1 < knots_.size(); ++i) join(knots_[i], interval(i - 1), interval(i));
  if (!loop_) return;  // the pose is held, at rest, before and after
  join(knots_.front(), interval(knots_.size() - 2), interval(0));
  knots_.back().velocity = knots_.front().velocity;
  knots_.back().angular_velocity_body = knots_.front().angular_velocity_body;
}

DeviceSample Trajectory::at(double time) const {
  const double end = knots_.back().time;
  if (loop_) time -= end * std::floor(time / end);
  time = std::clamp(time, 0.0, end);
  const auto next = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, time,
                                     [](double t, const Knot& knot) { return t < knot.time; });
  const Knot &a = *(next - 1), &b = *next;
  const double h = b.time - a.time;
  const double s = (time - a.time) / h, r = 1 - s;

  DeviceSample sample;
  const Vec3 step = b.pose.position - a.pose.position;
  sample.pose.position =
      a.pose.position + s * s * (3 - 2 * s) * step + h * s * r * (r * a.velocity - s * b.velocity);
  sample.twist.linear =
      6 * s * r / h * step + r * (1 - 3 * s) * a.velocity + s * (3 * s - 2) * b.velocity;

  // q = q_a exp(β₁w₁) exp(β₂w₂) exp(β₃w₃) with the cumulative cubic Bernstein functions
  // β₁ = 1 − r³, β₂ = s²(3 − 2s), β₃ = s³. Its rate in the body's frame is the sum of the three
  // β̇ᵢwᵢ, each turned into the frame behind the factors on its right.
  const Vec3 w1 = h / 3 * a.angular_velocity_body;
  const Vec3 w3 = h / 3 * b.angular_velocity_body;
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
