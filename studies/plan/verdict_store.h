// Verdicts that shards of a plan leave for each other, a file each, which appears whole or not at
// all. Loads are of the machine that measured them, and say which.
#pragma once

#include <filesystem>
#include <string>

#include "studies/plan/verdict.h"

namespace palpate::plan {

struct StoredVerdict {
  Verdict verdict;
  std::string machine;  ///< its loads are of
};

class VerdictStore {
 public:
  /// @param folder  empty: nothing is stored
  /// @param of      scene, options and program that all verdicts are of: others are not read
  VerdictStore(std::filesystem::path folder, std::string of);

  std::string key(const std::string& organ, const Candidate& candidate) const;
  /// @returns false if it is not there
  bool read(const std::string& organ, const Candidate& candidate, StoredVerdict& out) const;
  /// @throws std::runtime_error if it cannot be written
  void write(const std::string& organ, const StoredVerdict& stored) const;

 private:
  std::filesystem::path folder_;
  std::string of_;
};

}  // namespace palpate::plan
