// Results of earlier runs, one file per case and setting, which appears whole or not at all.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "studies/chart/cases.h"
#include "studies/report/point_files.h"

namespace palpate::chart {

class PointStore {
 public:
  /// @param folder  made if need be
  /// @param log     told of points that are not whole
  PointStore(const std::filesystem::path& folder, std::ostream& log);

  /// @param key  Setting::key() or reference_key()
  /// @returns false if it has not been measured, by another version of this program, or is not
  ///          whole
  bool read(const Case& of, const std::string& key, Measurement& out) const;
  void write(const Case& of, const std::string& key, const Measurement& measurement) const;
  /// A word for the point, in all runs that would measure the same.
  std::string point_key(const Case& of, const std::string& key) const { return name_of(of, key); }

 private:
  static std::string name_of(const Case& of, const std::string& key);

  report::PointFiles files_;
};

/// "reference-1"
std::string reference_key(int level);

}  // namespace palpate::chart
