// The gate every recorded pose passes, whatever file it comes from: what is left out, what is
// reported, what is refused.
//
// Left out, with a warning: a pose whose time is less than 1 µs after the one before it (repeated,
// or up to kLongestWayBack earlier), whose position is not finite or beyond 1000 m, or whose
// quaternion's length differs from 1 by more than 1e-3; accepted quaternions are normalised.
// Refused: a time that goes back further (two recordings in one file), more poses left out than
// kept (repeated ones not counted), fewer than two, more than kMostPoses.
// Reported and kept: gaps (a step over 0.1 s or over five times the median step, which the
// interpolation bridges) and jumps (faster than any hand: kMaxProbeSpeed, or 50 rad/s).
// Of each kind the first 20 are told in full, the rest by their number; gaps of half a second and
// more between most poses of a table are none of a recorder's, but of a wrong unit, and one line.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "modules/trajectories/timed_pose.h"

namespace palpate::trajectories {

inline constexpr double kLongestWayBack = 1;           ///< [s]
inline constexpr std::size_t kMostPoses = 50'000'000;  ///< of 80 bytes each: 4 GB

/// Whether a warning is about steps alone, which mean nothing where only the way counts.
bool is_of_steps(const std::string& warning);

class PoseCollector {
 public:
  /// @param file      as named in messages
  /// @param ordinal   what stands between it and a place's number: ":" or ": message "
  /// @param warnings  gets a line each
  PoseCollector(std::string file, std::string ordinal, std::vector<std::string>& warnings);

  /// Makes room, so that memory is taken once. Never more than for kMostPoses.
  void expect(std::size_t poses);

  /// A pose as it stands in the file.
  /// @param place  number of its line or message, rising
  /// @throws InputError
  void add(std::size_t place, double time, const Pose& pose);
  /// A line or message that holds no pose.
  void leave_out(std::size_t place, const std::string& why);

  std::size_t size() const { return poses_.size(); }

  /// @param end  number of the last line or message
  /// @throws InputError
  std::vector<TimedPose> finish(std::size_t end) &&;

 private:
  struct Kind {
    std::size_t count = 0, worst_place = 0;
    double worst = 0;
  };
  std::string wrong_with(const TimedPose& pose) const;
  void report_steps();
  void report_gaps(double longest_regular);
  void report_jumps();
  double median_step() const;
  std::string at(std::size_t place) const;
  std::size_t place_of(std::size_t pose) const;
  bool tell(Kind& kind, double size, std::size_t place, const std::string& text);

  std::string file_, ordinal_;
  std::vector<std::string>& warnings_;
  std::vector<TimedPose> poses_;
  std::size_t left_out_ = 0, repeated_ = 0;
  std::string last_reason_;
  /// From this pose on, how much its place's number is ahead of its own.
  std::vector<std::pair<std::size_t, std::size_t>> ahead_;
};

/// Six digits.
std::string short_text(double value);

}  // namespace palpate::trajectories
