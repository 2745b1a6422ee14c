#include "modules/trajectories/pose_collector.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "modules/core/error.h"
#include "modules/core/rotation_vector.h"
#include "modules/core/tolerances.h"

namespace palpate::trajectories {
namespace {

constexpr double kShortestStep = 1e-6;  // [s]
constexpr double kLongestStep = 0.1;    // more is a gap [s]
constexpr double kGapOverMedian = 5;
constexpr double kFastestTurn = 50;  // of a wrist, with room [rad/s]
constexpr std::size_t kToldInFull = 20;
constexpr std::size_t kMedianOf = 1'000'000;  // steps at most, evenly spread

constexpr double kSlowestRecorder = 0.5;  // of whose poses most are as far apart [s]
// What tells of steps says so in these words.
constexpr const char* kGap = "gap of ";
constexpr const char* kGaps = " gaps, the longest";
constexpr const char* kApart = " apart ";

/// @param median  step, read as seconds
std::string doubt_about_times(double median) {
  const std::pair<const char*, const char*> unit = median < 1e3   ? std::pair("milliseconds", "ms")
                                                   : median < 1e6 ? std::pair("microseconds", "us")
                                                                  : std::pair("nanoseconds", "ns");
  return fmt::format("are its times in {}? Then say time_unit: {}", unit.first, unit.second);
}

double distance(const TimedPose& a, const TimedPose& b) {
  return (b.pose.position - a.pose.position).norm();
}

double angle(const TimedPose& a, const TimedPose& b) {
  return vector_from_rotation(a.pose.rotation.conjugate() * b.pose.rotation).norm();
}

}  // namespace

bool is_of_steps(const std::string& warning) {
  return std::ranges::any_of(std::array{kGap, kGaps, kApart}, [&](const char* words) {
    return warning.find(words) != std::string::npos;
  });
}

std::string short_text(double value) { return fmt::format("{:.6g}", value); }

PoseCollector::PoseCollector(std::string file, std::string ordinal,
                             std::vector<std::string>& warnings)
    : file_(std::move(file)), ordinal_(std::move(ordinal)), warnings_(warnings) {}

void PoseCollector::expect(std::size_t poses) { poses_.reserve(std::min(poses, kMostPoses)); }

std::string PoseCollector::at(std::size_t place) const {
  return file_ + ordinal_ + std::to_string(place) + ": ";
}

void PoseCollector::add(std::size_t place, double time, const Pose& pose) {
  TimedPose timed{time, pose};
  if (!poses_.empty()) {
    const double step = time - poses_.back().time;
    if (step < -kLongestWayBack) {
      throw InputError(fmt::format(
          "{}time goes back by {} s; at most {} s is taken for disorder. Are these two recordings "
          "in one?",
          at(place), short_text(-step), kLongestWayBack));
    }
    repeated_ += std::abs(step) < kShortestStep;
  }
  if (const std::string wrong = wrong_with(timed); !wrong.empty()) return leave_out(place, wrong);
  if (poses_.size() == kMostPoses) {
    throw InputError(
        fmt::format("{}more than {} poses; split the recording", at(place), kMostPoses));
  }
  timed.pose.rotation.normalize();
  const std::size_t ahead = place - poses_.size();
  if (ahead_.empty() || ahead_.back().second != ahead) ahead_.emplace_back(poses_.size(), ahead);
  poses_.push_back(timed);
}

void PoseCollector::leave_out(std::size_t place, const std::string& why) {
  last_reason_ = at(place) + "left out: " + why;
  if (++left_out_ <= kToldInFull) warnings_.push_back(last_reason_);
}

/// Empty if nothing is.
std::string PoseCollector::wrong_with(const TimedPose& timed) const {
  const auto& [time, pose] = timed;
  if (!std::isfinite(time)) return "its time is not a finite number";
  if (!poses_.empty() && !(time - poses_.back().time >= kShortestStep)) {
    return fmt::format("t = {} s is not at least 1e-6 s after the previous {} s", short_text(time),
                       short_text(poses_.back().time));
  }
  if (!(pose.position.stableNorm() <= kWorldReach)) {
    return fmt::format("position is beyond {} m (see key length_unit)", kWorldReach);
  }
  const double length = pose.rotation.coeffs().stableNorm();
  if (!(std::abs(length - 1) <= kWrittenUnitTolerance)) {
    return fmt::format("quaternion has length {}, must be 1 within {}", short_text(length),
                       kWrittenUnitTolerance);
  }
  return {};
}

std::vector<TimedPose> PoseCollector::finish(std::size_t end) && {
  if (left_out_ > kToldInFull) {
    warnings_.push_back(at(end) + "in all " + std::to_string(left_out_) + " left out, of these " +
                        std::to_string(repeated_) + " with a repeated time");
  }
  const std::string last = last_reason_.empty() ? "" : " (last: " + last_reason_ + ")";
  if (poses_.size() < 2) {
    throw InputError(fmt::format("{}only {} usable poses, at least 2 are needed{}", at(end),
                                 poses_.size(), last));
  }
  if (left_out_ - repeated_ > poses_.size()) {
    throw InputError(fmt::format("{}{} poses cannot be used, only {} can{}", at(end),
                                 left_out_ - repeated_, poses_.size(), last));
  }
  report_steps();
  report_jumps();
  return std::move(poses_);
}

std::size_t PoseCollector::place_of(std::size_t pose) const {
  const auto next = std::upper_bound(ahead_.begin(), ahead_.end(), pose,
                                     [](std::size_t i, const auto& run) { return i < run.first; });
  return pose + std::prev(next)->second;
}

/// @returns true while each of its kind is told in full
bool PoseCollector::tell(Kind& kind, double size, std::size_t place, const std::string& text) {
  if (size > kind.worst) kind.worst = size, kind.worst_place = place;
  if (++kind.count > kToldInFull) return false;
  warnings_.push_back(at(place) + text);
  return true;
}

double PoseCollector::median_step() const {
  const std::size_t stride = (poses_.size() - 1) / kMedianOf + 1;
  std::vector<double> steps;
  for (std::size_t i = 0; i + 1 < poses_.size(); i += stride) {
    steps.push_back(poses_[i + 1].time - poses_[i].time);
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

void PoseCollector::report_steps() {
  const double median = median_step();
  const bool is_table = ordinal_ == ":";  // a bag's times have no unit to choose
  if (is_table && median >= kSlowestRecorder && poses_.size() > kToldInFull) {
    warnings_.push_back(fmt::format("{}: {} poses, {} s{}in the median: {}", file_, poses_.size(),
                                    short_text(median), kApart, doubt_about_times(median)));
  } else {
    report_gaps(std::min(kLongestStep, kGapOverMedian * median));
  }
}

void PoseCollector::report_gaps(double longest_regular) {
  Kind gaps;
  for (std::size_t i = 0; i + 1 < poses_.size(); ++i) {
    const double step = poses_[i + 1].time - poses_[i].time;
    if (step <= longest_regular) continue;
    tell(gaps, step, place_of(i + 1),
         fmt::format("{}{} s before t = {} s, bridged by interpolation", kGap, short_text(step),
                     short_text(poses_[i + 1].time)));
  }
  if (gaps.count > kToldInFull) {
    warnings_.push_back(fmt::format("{}in all {}{}, here, of {} s", at(gaps.worst_place),
                                    gaps.count, kGaps, short_text(gaps.worst)));
  }
}

void PoseCollector::report_jumps() {
  const auto is_jump = [](const TimedPose& a, const TimedPose& b) {
    const double step = b.time - a.time;
    return distance(a, b) > kMaxProbeSpeed * step || angle(a, b) > kFastestTurn * step;
  };
  std::size_t all = 0;
  for (std::size_t i = 0; i + 1 < poses_.size(); ++i) all += is_jump(poses_[i], poses_[i + 1]);
  if (all == 0) return;
  if (10 * all > poses_.size()) {
    warnings_.push_back(fmt::format(
        "{}: {} of {} steps are faster than {} m/s or {} rad/s, which no hand is; see keys "
        "length_unit, time_unit and quaternion",
        file_, all, poses_.size() - 1, kMaxProbeSpeed, kFastestTurn));
    return;
  }
  Kind jumps;
  for (std::size_t i = 0; i + 1 < poses_.size(); ++i) {
    const TimedPose &a = poses_[i], &b = poses_[i + 1];
    if (!is_jump(a, b)) continue;
    const double step = b.time - a.time;
    tell(jumps, distance(a, b), place_of(i + 1),
         fmt::format("jump of {} mm and {} rad in {} s before t = {} s, played as it is",
                     short_text(1e3 * distance(a, b)), short_text(angle(a, b)), short_text(step),
                     short_text(b.time)));
  }
  if (jumps.count > kToldInFull) {
    warnings_.push_back(fmt::format("{}in all {} jumps, the longest, here, of {} mm",
                                    at(jumps.worst_place), jumps.count,
                                    short_text(1e3 * jumps.worst)));
  }
}

}  // namespace palpate::trajectories
