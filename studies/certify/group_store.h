// What shards of a certificate leave for each other: the lines of one group of measurements each,
// in a file that appears whole or not at all. Of runs in lockstep, which give the same numbers
// everywhere.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "modules/messages/messages.h"
#include "studies/certify/line.h"
#include "studies/report/point_files.h"

namespace palpate::certify {

struct GroupResult {
  std::vector<Line> lines;
  ContactTroubles troubles;
  double push = 0;  ///< of the first group: what the organ holds at the depth of presses [N]
};

class GroupStore {
 public:
  /// @param of   scene, options and program that all results are of: others are not read
  /// @param log  told of results that are not whole
  GroupStore(const std::filesystem::path& folder, std::string of, std::ostream& log);

  std::string key(const std::string& group) const;
  /// @returns false if it is not there, or not whole
  bool read(const std::string& group, GroupResult& out) const;
  /// @throws std::runtime_error if it cannot be written
  void write(const std::string& group, const GroupResult& result) const;

 private:
  report::PointFiles files_;
  std::string of_;
};

}  // namespace palpate::certify
