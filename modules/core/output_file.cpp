#include "modules/core/output_file.h"

#include <unistd.h>

#include "modules/core/error.h"

namespace palpate {

std::string why_not_writable(const std::filesystem::path& file) {
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  std::error_code none;
  if (!std::filesystem::is_directory(folder, none)) return "there is no folder " + folder.string();
  if (std::filesystem::is_directory(file, none)) return "it is a folder";
  const bool is_there = std::filesystem::exists(std::filesystem::symlink_status(file, none));
  if (is_there) return ::access(file.c_str(), W_OK) == 0 ? "" : "it may not be written to";
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return "";
  return "the folder " + folder.string() + " may not be written to";
}

void check_writable(const std::filesystem::path& file) {
  const std::string why = why_not_writable(file);
  if (!why.empty()) throw InputError(file.string() + ": cannot be written: " + why);
}

}  // namespace palpate
