// How much room the disk of a recording still has.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace palpate::recording {

/// A recording ends, whole, while this is left: for its summary, and for everybody else [bytes].
inline constexpr std::uint64_t kSpaceKept = 256u << 20;

/// Before anything is begun whose recording it is to be.
/// @throws std::runtime_error naming the file where no more than that is left
void check_recording_space(const std::filesystem::path& file);

class SpaceWatch {
 public:
  using Available = std::function<std::uint64_t()>;

  /// Watches the disk that `file` lies on.
  explicit SpaceWatch(const std::filesystem::path& file);
  explicit SpaceWatch(Available available) : available_(std::move(available)) {}

  /// Looks, at most once a second.
  /// @param now, written  time [s] and bytes of the recording so far
  /// @return what is to be said: once when the space will last for less than ten minutes at the
  /// rate of writing so far, and once when it is used up
  std::string look(double now, std::uint64_t written);

  bool full() const { return full_; }

 private:
  Available available_;
  double began_ = -1, looked_ = -1;
  bool warned_ = false;
  bool full_ = false;
};

}  // namespace palpate::recording
