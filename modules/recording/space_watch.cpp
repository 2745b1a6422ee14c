#include "modules/recording/space_watch.h"

#include <limits>

namespace palpate::recording {
namespace {

constexpr double kLookEvery = 1;        // [s]
constexpr double kWarnBefore = 600;     // [s] at the present rate
constexpr double kRateKnownAfter = 10;  // [s]

std::string megabytes(std::uint64_t bytes) { return std::to_string(bytes >> 20) + " MiB"; }

std::uint64_t available_beside(const std::filesystem::path& file) {
  std::error_code error;
  const auto folder = std::filesystem::absolute(file).parent_path();
  const auto space = std::filesystem::space(folder, error);
  return error ? std::numeric_limits<std::uint64_t>::max() : space.available;
}

}  // namespace

SpaceWatch::SpaceWatch(const std::filesystem::path& file)
    : SpaceWatch([file] { return available_beside(file); }) {}

std::string SpaceWatch::look(double now, std::uint64_t written) {
  if (full_ || (looked_ >= 0 && now - looked_ < kLookEvery)) return {};
  if (began_ < 0) began_ = now;
  looked_ = now;
  const std::uint64_t available = available_();
  full_ = available < kSpaceKept;
  if (full_) {
    return "the disk is full but for " + megabytes(available) +
           ": the recording ends here, whole; the session goes on without it";
  }
  if (warned_ || now - began_ < kRateKnownAfter) return {};
  const double per_second = static_cast<double>(written) / (now - began_);
  const double left = static_cast<double>(available - kSpaceKept) / per_second;
  warned_ = left < kWarnBefore;
  if (!warned_) return {};
  return megabytes(available) + " left on the disk: room for " +
         std::to_string(static_cast<int>(left / 60)) + " min " +
         std::to_string(static_cast<int>(left) % 60) + " s of this recording";
}

}  // namespace palpate::recording
