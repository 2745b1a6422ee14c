// A file that lives as long as a test.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace palpate {

class TemporaryFile {
 public:
  /// In a folder of this process' own, so that tests may run beside each other.
  TemporaryFile(const std::string& name, const std::string& text)
      : folder_(std::filesystem::temp_directory_path() /
                ("palpate_haptics_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    std::ofstream(path_ = folder_ / name) << text;
  }
  ~TemporaryFile() { std::filesystem::remove_all(folder_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path folder_, path_;
};

}  // namespace palpate
