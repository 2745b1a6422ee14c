// Whether a recorder has met all whom it is to record: a session that waits for it is on record
// from its first sample on.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "modules/recording/session_samples.h"

namespace palpate::recording {

class Hearing {
 public:
  /// To be made after the readers that record. DDS tells of readers in the order in which they were
  /// made: whose status comes to this one knows those, too.
  /// @param modules  names of a scene's modules
  Hearing(bus::Bus& bus, std::vector<std::string> modules);

  /// Takes what has arrived. True once each module has said that it is ready, and `reader`, which
  /// records, has met all writers of them and of the launcher, as far as it hears their topics.
  bool complete(const SessionReader& reader);

 private:
  bool met_all(const SessionReader& reader) const;

  bus::Reader<ModuleStatus> statuses_;
  ModuleStatus status_;
  std::vector<std::string> modules_;
  std::set<std::string> not_ready_;
  bool complete_ = false;
};

}  // namespace palpate::recording
