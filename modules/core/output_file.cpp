#include "modules/core/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "modules/core/error.h"
#include "modules/core/signals_held_back.h"

namespace palpate {

namespace {

/// Root may write to any folder by its mode; /proc takes no files all the same.
std::string why_takes_no_file(const std::filesystem::path& folder) {
  const SignalsHeldBack held;
  std::string name = (folder / ".palpate-XXXXXX").string();
  const int number = ::mkostemp(name.data(), O_CLOEXEC);
  if (number < 0)
    return "the folder " + folder.string() + " takes no file: " + std::strerror(errno);
  ::close(number);
  ::unlink(name.c_str());
  return "";
}

}  // namespace

std::string why_not_writable(const std::filesystem::path& file) {
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  std::error_code none;
  if (!std::filesystem::is_directory(folder, none)) return "there is no folder " + folder.string();
  if (std::filesystem::is_directory(file, none)) return "it is a folder";
  const auto there = std::filesystem::symlink_status(file, none);
  if (there.type() == std::filesystem::file_type::none) return none.message();  // a name too long
  const bool is_there = std::filesystem::exists(there);
  if (is_there && !std::filesystem::exists(file, none)) {
    return "it is a link that leads to no file";
  }
  if (is_there && ::access(file.c_str(), W_OK) != 0) return "it may not be written to";
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return why_takes_no_file(folder);
  return "the folder " + folder.string() + " may not be written to";
}

bool is_disk_full(int system_error) {
  return system_error == ENOSPC || system_error == EDQUOT || system_error == EFBIG;
}

void check_writable(const std::filesystem::path& file) {
  const std::string why = why_not_writable(file);
  if (!why.empty()) throw InputError(file.string() + ": cannot be written: " + why);
}

void make_writable_folder(const std::filesystem::path& folder, const std::string& option) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && ::access(folder.c_str(), W_OK | X_OK) != 0) {
    error = std::error_code(errno, std::generic_category());
  }
  if (!error) return;
  throw InputError(option + " '" + folder.string() + "': must be a folder that can be written (" +
                   error.message() + ")");
}

void check_replaces_its_like(const std::filesystem::path& file, std::string_view beginning,
                             const std::string& kind) {
  check_writable(file);
  std::error_code none;
  const auto type = std::filesystem::status(file, none).type();
  if (type == std::filesystem::file_type::not_found) return;
  const auto refuse = [&] {
    throw InputError(file.string() + ": is no " + kind + ", and is not replaced by one");
  };
  if (type != std::filesystem::file_type::regular) refuse();  // before it is opened: a FIFO
  std::string first(beginning.size(), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(first.data(), static_cast<std::streamsize>(first.size()));
  if (stream.gcount() > 0 && first != beginning) refuse();
}

}  // namespace palpate
