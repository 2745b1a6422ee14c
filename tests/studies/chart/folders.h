// Folders the tests of this layer use.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "studies/chart/cases.h"

namespace palpate::accuracy::testing {

class WorkFolder {
 public:
  WorkFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "palpate_acc_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    path = name;
  }
  ~WorkFolder() { std::filesystem::remove_all(path); }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  std::filesystem::path path;
};

inline Source source() {
  const std::filesystem::path root = PALPATE_SOURCE_DIR;
  Source source{root / "studies/reference", root / "scenes", {}};
  const char* data = std::getenv("PALPATE_DATA");
  const std::filesystem::path folder = data != nullptr ? data : root / "../shared/data";
  if (std::filesystem::exists(folder / "truthcube")) source.data = folder;
  return source;
}

}  // namespace palpate::accuracy::testing
