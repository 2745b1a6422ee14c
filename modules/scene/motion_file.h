// What kind of file a recorded motion is in, by its name.
#pragma once

#include <filesystem>

namespace palpate::scene {

enum class MotionFile { kTable, kRos1Bag, kMcapBag };

inline MotionFile motion_file_of(const std::filesystem::path& file) {
  if (file.extension() == ".bag") return MotionFile::kRos1Bag;
  if (file.extension() == ".mcap") return MotionFile::kMcapBag;
  return MotionFile::kTable;
}

}  // namespace palpate::scene
