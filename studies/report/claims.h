// `--shard I/N`: several runs share a folder, on one machine or on many, and each point of a study
// is measured by one of them.
//
// Before a run measures a point, it makes a file KEY.claim there with O_EXCL, which a file system
// grants to one only; NFS since version 3, too. While it measures, it sets the file's time anew. A
// claim whose time has stood for kTakenOverAfter is of a run that died: the next makes
// KEY.claim-2, again with O_EXCL, so that of several one takes over. Nothing is deleted but one's
// own claim by a run that is stopped, so no two can each take the other's for a dead one's. Ages
// are differences of times that the file system set: clocks of machines do not matter.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::report {

inline constexpr std::chrono::seconds kTakenOverAfter{600};

struct Shard {
  std::size_t index = 1, count = 1;  ///< 1 … count
};

inline constexpr const char* kShardHelp =
    "I/N, one of N runs on the same --out folder: measures points that no other run does, writes "
    "no tables; afterwards a run without it does";

/// @param text  "2/8"
/// @throws InputError
Shard shard_from(const std::string& text);

class Claims {
 public:
  /// @param folder  of the claims, made if need be
  /// @param shard   none: this run takes every point, and claims none
  Claims(std::filesystem::path folder, std::optional<Shard> shard,
         std::chrono::seconds taken_over_after = kTakenOverAfter);
  ~Claims();  ///< gives back what was taken and not finished
  Claims(const Claims&) = delete;
  Claims& operator=(const Claims&) = delete;

  const std::optional<Shard>& shard() const { return shard_; }
  /// @returns whether this run is to measure the point. One at a time.
  /// @param key  of the point, the same in all runs; a name of a file
  bool take(const std::string& key);
  void finish() { taken_.clear(); }  ///< the point taken is stored
  /// Called often while a point is measured; touches the file now and then.
  void keep();

 private:
  bool is_dead(const std::filesystem::path& claim);

  std::filesystem::path folder_;
  std::optional<Shard> shard_;
  std::chrono::seconds taken_over_after_;
  std::filesystem::path taken_;  ///< the claim; empty: none
  std::chrono::steady_clock::time_point kept_;
};

/// A point of a study.
struct Point {
  std::string key;
  std::function<bool()> read;     ///< what an earlier run stored; false: there is nothing
  std::function<void()> measure;  ///< and store
};

struct Share {
  std::size_t measured = 0, stored = 0, elsewhere = 0;

  Share& operator+=(const Share& other) {
    measured += other.measured;
    stored += other.stored;
    elsewhere += other.elsewhere;
    return *this;
  }
};

/// Reads or measures each point; a shard begins with its own part, goes round, and leaves out what
/// others measure. What is measured is read back: a result is what is stored, whoever measured it.
/// @throws what a point throws
Share measure_points(const std::vector<Point>& points, Claims& claims);

/// "shard 2/8: 12 points measured here, 30 stored before, 3 being measured by others; …"
std::string text_of(const Share& share, const Shard& shard);

}  // namespace palpate::report
