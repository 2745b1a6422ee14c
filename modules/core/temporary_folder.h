// A folder that vanishes with its owner, whatever signal comes: who works in it looks at
// StopSignal.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "modules/core/stop_signal.h"

namespace palpate {

class TemporaryFolder {
 public:
  /// @throws std::runtime_error if it cannot be made
  TemporaryFolder() {
    std::error_code missing;
    std::string name = (std::filesystem::temp_directory_path(missing) / "palpate-XXXXXX").string();
    if (missing || ::mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error(
          "cannot make a temporary folder: TMPDIR (or else /tmp) must be a "
          "folder that can be written");
    }
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// @throws std::runtime_error if it cannot be written
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    const auto file = path_ / name;
    std::ofstream stream(file);
    if (!(stream << text << std::flush)) throw std::runtime_error("cannot write " + file.string());
    return file;
  }

 private:
  StopSignal stop_;  // outlives the folder
  std::filesystem::path path_;
};

}  // namespace palpate
