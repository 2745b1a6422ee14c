#include "modules/core/data_folder.h"

#include <cstdlib>

#include "modules/core/error.h"

namespace palpate {

std::filesystem::path program_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

std::filesystem::path data_folder() {
  if (const char* share = std::getenv("PALPATE_SHARE"); share != nullptr && *share != '\0') {
    return share;
  }
  return program_folder().parent_path() / "share" / "palpate";
}

std::filesystem::path data_file(const std::filesystem::path& name) {
  auto file = data_folder() / name;
  if (std::filesystem::exists(file)) return file;
  throw InputError(file.string() +
                   ": not there; PALPATE_SHARE names the folder that holds Palpate's data");
}

}  // namespace palpate
