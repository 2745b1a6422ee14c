#include "modules/recording/space_watch.h"

#include <limits>
#include <stdexcept>

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

std::string kept_free(std::uint64_t available) {
  return megabytes(available) + " left on the disk, of which " + megabytes(kSpaceKept) +
         " are kept free";
}

}  // namespace

void check_recording_space(const std::filesystem::path& file) {
  std::error_code none;
  const std::uintmax_t replaced = std::filesystem::file_size(file, none);
  const std::uint64_t available = available_beside(file);
  if (available >= kSpaceKept || (!none && available + replaced >= kSpaceKept)) return;
  throw std::runtime_error(file.string() + ": cannot be recorded to: " + kept_free(available));
}

SpaceWatch::SpaceWatch(const std::filesystem::path& file)
    : SpaceWatch([file] { return available_beside(file); }) {}

std::string SpaceWatch::look(double now, std::uint64_t written) {
  if (full_ || (looked_ >= 0 && now - looked_ < kLookEvery)) return {};
  if (began_ < 0) began_ = now;
  looked_ = now;
  const std::uint64_t available = available_();
  full_ = available < kSpaceKept;
  if (full_) {
    return kept_free(available) + ": the recording ends here, whole";
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
