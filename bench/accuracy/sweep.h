// Which settings of which models are measured in which case, and what has been measured already.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "bench/accuracy/cases.h"

namespace palpate::accuracy {

enum class Extent { kQuick, kUsual, kFull };

/// All settings of a case, cheap ones first; where the truth is the finest accurate rung, that one
/// is the very first.
std::vector<Setting> settings_of(const Case& of, Extent extent);

/// The setting whose answers are the truth of a case with truth_is_finest: level 1, or the finest
/// where hours are there.
Setting truth_setting(const Case& of, Extent extent);

/// Results of earlier runs, one file per case and setting, which appears whole or not at all.
class PointStore {
 public:
  /// @param folder  made if need be
  explicit PointStore(std::filesystem::path folder);

  /// @returns false if it has not been measured, or by another version of this program
  bool read(const Case& of, const Setting& setting, Measurement& out) const;
  void write(const Case& of, const Setting& setting, const Measurement& measurement) const;

 private:
  std::filesystem::path file_of(const Case& of, const Setting& setting) const;

  std::filesystem::path folder_;
};

struct Point {
  Case of;
  Setting setting;
  Measurement measurement;
};

/// Measures what is not in the store yet.
/// @param begin  told of each setting before it is measured: what, how many of how many
/// @throws what a measurement throws; finished points stay in the store
std::vector<Point> sweep(const std::vector<Case>& of, Extent extent,
                         const std::vector<scene::Model>& models, const Source& source,
                         const PointStore& store,
                         const std::function<void(const std::string&, int, int)>& begin,
                         const KeepGoing& keep_going);

}  // namespace palpate::accuracy
