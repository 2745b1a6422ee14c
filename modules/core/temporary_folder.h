// A folder that vanishes with its owner, whatever signal comes: who works in it looks at
// StopSignal.
#pragma once

#include <filesystem>
#include <string>

#include "modules/core/stop_signal.h"

namespace palpate {

/// Held by a lock that the kernel gives back should the owner be killed: the next one that is made
/// by this user on this host removes what is left.
class TemporaryFolder {
 public:
  /// @throws std::runtime_error if it cannot be made
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// @throws std::runtime_error if it cannot be written
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  StopSignal stop_;  // outlives the folder
  std::filesystem::path path_;
  int lock_ = -1;
};

}  // namespace palpate
