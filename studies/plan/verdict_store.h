// Verdicts that shards of a plan leave for each other, a file each, which appears whole or not at
// all. Loads are of the machine that measured them, and say which.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "studies/plan/verdict.h"
#include "studies/report/point_files.h"

namespace palpate::plan {

struct StoredVerdict {
  Verdict verdict;
  std::string machine;  ///< its loads are of
};

class VerdictStore {
 public:
  /// @param folder  empty: nothing is stored
  /// @param of      scene, options and program that all verdicts are of: others are not read
  /// @param log     told of verdicts that are not whole
  VerdictStore(const std::filesystem::path& folder, std::string of, std::ostream& log);

  std::string key(const std::string& organ, const Candidate& candidate) const;
  /// @returns false if it is not there, or not whole
  bool read(const std::string& organ, const Candidate& candidate, StoredVerdict& out) const;
  /// @throws std::runtime_error if it cannot be written
  void write(const std::string& organ, const StoredVerdict& stored) const;

 private:
  bool stores_;
  report::PointFiles files_;
  std::string of_;
};

}  // namespace palpate::plan
