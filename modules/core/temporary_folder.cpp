#include "modules/core/temporary_folder.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "modules/core/whole_file.h"

namespace palpate {
namespace {

constexpr std::string_view kUnique = "XXXXXX";

/// "palpate-HOST-": two hosts may share the place, and do not see each other's locks.
std::string names_of_this_host() {
  const std::string word = process_word();
  return "palpate-" + word.substr(0, word.rfind('-') + 1);
}

/// Whether a name goes on as one of ours does: "PID-XXXXXX".
bool is_ours(std::string_view rest) {
  const std::size_t dash = rest.find('-');
  return dash != 0 && dash != std::string_view::npos && rest.size() == dash + 1 + kUnique.size() &&
         std::all_of(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(dash),
                     [](unsigned char letter) { return std::isdigit(letter) != 0; });
}

/// @returns its descriptor, with the lock; -1 if somebody else has that, or it is no folder of ours
int locked(const std::filesystem::path& folder) {
  const int number = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (number < 0) return -1;
  struct stat held {
  }, named{};
  const bool is_own = ::flock(number, LOCK_EX | LOCK_NB) == 0 && ::fstat(number, &held) == 0 &&
                      held.st_uid == ::geteuid() && ::lstat(folder.c_str(), &named) == 0 &&
                      held.st_ino == named.st_ino;
  if (is_own) return number;
  ::close(number);
  return -1;
}

/// Of owners that were killed. One just made and not yet locked may be among them: its owner sees
/// that, and makes another.
void remove_left_in(const std::filesystem::path& place) {
  const std::string ours = names_of_this_host();
  std::error_code error;
  for (std::filesystem::directory_iterator entry(place, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(ours) || !is_ours(std::string_view(name).substr(ours.size()))) continue;
    const int lock = locked(entry->path());
    if (lock < 0) continue;
    std::error_code ignored;
    std::filesystem::remove_all(entry->path(), ignored);
    ::close(lock);
  }
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::error_code missing;
  const auto place = std::filesystem::temp_directory_path(missing);
  if (!missing) remove_left_in(place);
  while (lock_ < 0) {
    std::string name =
        (place / ("palpate-" + process_word() + "-" + std::string(kUnique))).string();
    if (missing || ::mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error(
          "cannot make a temporary folder: TMPDIR (or else /tmp) must be a "
          "folder that can be written");
    }
    path_ = name;
    lock_ = locked(path_);
    if (lock_ < 0 && std::filesystem::exists(path_, missing)) break;  // a place without locks
  }
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

std::filesystem::path TemporaryFolder::write(const std::string& name,
                                             const std::string& text) const {
  const auto file = path_ / name;
  std::ofstream stream(file);
  if (!(stream << text << std::flush)) throw std::runtime_error("cannot write " + file.string());
  return file;
}

}  // namespace palpate
