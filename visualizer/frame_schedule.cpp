#include "visualizer/frame_schedule.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace palpate::visualizer {

bool FrameSchedule::take_due(double time) {
  if (time < last_) next_ = 0;
  if (time < next_) return false;
  last_ = time;
  next_ = (std::floor(time / interval_) + 1) * interval_;
  return true;
}

std::filesystem::path frame_name(double time) {
  std::array<char, 40> name{};
  std::snprintf(name.data(), name.size(), "frame_%010.3f.png", time);
  return name.data();
}

std::filesystem::path unused_name(const std::filesystem::path& file) {
  std::error_code none;
  std::filesystem::path name = file;
  for (int number = 2; std::filesystem::exists(name, none); ++number) {
    name.replace_filename(file.stem().string() + "-" + std::to_string(number) +
                          file.extension().string());
  }
  return name;
}

}  // namespace palpate::visualizer
