#include "studies/report/claims.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <stdexcept>

#include "modules/core/error.h"
#include "modules/core/whole_file.h"
#include "studies/report/measures.h"

namespace palpate::report {
namespace {

constexpr std::size_t kMostShards = 100'000;
constexpr std::chrono::seconds kKeepEvery{20};

[[noreturn]] void cannot(const std::filesystem::path& file) {
  throw std::runtime_error("cannot write " + file.string() + ": " + std::strerror(errno));
}

/// @returns false if it is there
bool make_alone(const std::filesystem::path& file) {
  const int made = ::open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
  if (made < 0 && errno == EEXIST) return false;
  if (made < 0) cannot(file);
  const std::string who = process_word() + '\n';
  const bool written = ::write(made, who.data(), who.size()) == static_cast<ssize_t>(who.size());
  if (::close(made) != 0 || !written) cannot(file);
  return true;
}

/// By the file system's own clock. @returns false if the file is not there
bool touch(const std::filesystem::path& file) {
  return ::utimensat(AT_FDCWD, file.c_str(), nullptr, 0) == 0;
}

/// Of its last touch [s].
std::optional<double> time_of(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return {};
  return double(status.st_mtim.tv_sec) + 1e-9 * double(status.st_mtim.tv_nsec);
}

}  // namespace

Shard shard_from(const std::string& text) {
  Shard shard{0, 0};
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec == std::errc{} && index.ptr != end && *index.ptr == '/') {
    const auto count = std::from_chars(index.ptr + 1, end, shard.count);
    if (count.ec == std::errc{} && count.ptr == end && shard.index >= 1 &&
        shard.index <= shard.count && shard.count <= kMostShards) {
      return shard;
    }
  }
  throw InputError("--shard '" + text +
                   "': must be I/N with 1 <= I <= N <= " + std::to_string(kMostShards));
}

Claims::Claims(std::filesystem::path folder, std::optional<Shard> shard,
               std::chrono::seconds taken_over_after)
    : folder_(std::move(folder)), shard_(shard), taken_over_after_(taken_over_after) {
  if (shard_) make_out_folder(folder_);
}

Claims::~Claims() {
  std::error_code ignored;
  if (!taken_.empty()) std::filesystem::remove(taken_, ignored);
}

bool Claims::is_dead(const std::filesystem::path& claim) {
  const auto now = folder_ / (".now-" + process_word());
  if (!touch(now)) make_alone(now);
  const auto present = time_of(now), last = time_of(claim);
  std::error_code ignored;
  std::filesystem::remove(now, ignored);
  return present && last && *present - *last > double(taken_over_after_.count());
}

bool Claims::take(const std::string& key) {
  if (!shard_) return true;
  for (int generation = 1;; ++generation) {
    const auto claim =
        folder_ / (key + ".claim" + (generation == 1 ? "" : "-" + std::to_string(generation)));
    if (make_alone(claim)) {
      taken_ = claim;
      kept_ = std::chrono::steady_clock::now();
      return true;
    }
    if (!is_dead(claim)) return false;
  }
}

void Claims::keep() {
  if (taken_.empty() || std::chrono::steady_clock::now() - kept_ < kKeepEvery) return;
  kept_ = std::chrono::steady_clock::now();
  touch(taken_);
}

Share measure_points(const std::vector<Point>& points, Claims& claims) {
  Share share;
  std::size_t first = 0;
  if (const auto& shard = claims.shard()) first = (shard->index - 1) * points.size() / shard->count;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point& point = points[(first + k) % points.size()];
    if (point.read()) {
      ++share.stored;
      continue;
    }
    if (!claims.take(point.key)) {
      ++share.elsewhere;
      continue;
    }
    if (point.read()) {  // stored between the look and the claim
      ++share.stored;
    } else {
      point.measure();
      ++share.measured;
      if (!point.read()) throw std::runtime_error("point " + point.key + " was not stored");
    }
    claims.finish();
  }
  return share;
}

std::string text_of(const Share& share, const Shard& shard) {
  return "shard " + std::to_string(shard.index) + "/" + std::to_string(shard.count) + ": " +
         std::to_string(share.measured) + " points measured here, " + std::to_string(share.stored) +
         " stored before, " + std::to_string(share.elsewhere) +
         " being measured by others; when all shards have ended, the same command without --shard "
         "makes the tables\n";
}

}  // namespace palpate::report
