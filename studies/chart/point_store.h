// Results of earlier runs, one file per case and setting, which appears whole or not at all.
#pragma once

#include <filesystem>
#include <string>

#include "studies/chart/cases.h"

namespace palpate::chart {

class PointStore {
 public:
  /// @param folder  made if need be
  explicit PointStore(std::filesystem::path folder);

  /// @param key  Setting::key() or reference_key()
  /// @returns false if it has not been measured, or by another version of this program
  bool read(const Case& of, const std::string& key, Measurement& out) const;
  void write(const Case& of, const std::string& key, const Measurement& measurement) const;
  /// A word for the point, in all runs that would measure the same.
  std::string point_key(const Case& of, const std::string& key) const {
    return file_of(of, key).stem().string();
  }

 private:
  std::filesystem::path file_of(const Case& of, const std::string& key) const;

  std::filesystem::path folder_;
};

/// "reference-1"
std::string reference_key(int level);

}  // namespace palpate::chart
