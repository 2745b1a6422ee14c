// When the next picture of a sequence is due, and what it is called.
#pragma once

#include <filesystem>

namespace palpate::visualizer {

/// One picture at the first chance after each multiple of the interval; none twice. A time before
/// the last picture's means that the session was reset: the sequence starts again.
class FrameSchedule {
 public:
  /// @param interval  > 0, simulated [s]
  explicit FrameSchedule(double interval) : interval_(interval) {}

  /// True if a picture of this simulated time [s] is due; it counts as made then.
  bool take_due(double time);

 private:
  double interval_;
  double last_ = 0;
  double next_ = 0;
};

/// The file, or FILE-2.png, FILE-3.png, … where that is there already.
std::filesystem::path unused_name(const std::filesystem::path& file);

/// "frame_000012.500.png": sorts by simulated time [s], 0 … 999999.
std::filesystem::path frame_name(double time);

}  // namespace palpate::visualizer
