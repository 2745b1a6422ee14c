#include "modules/core/files_of_kind.h"

#include <algorithm>
#include <fstream>

#include "modules/core/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

bool is_of_kind(const fs::directory_entry& entry, const FileKind& kind) {
  const std::string name = entry.path().filename().string();
  std::error_code none;
  if (!name.starts_with(kind.name_begins) || !name.ends_with(kind.extension)) return false;
  if (!entry.is_regular_file(none)) return false;  // before it is opened: a FIFO
  std::string first(kind.begins.size(), '\0');
  std::ifstream stream(entry.path(), std::ios::binary);
  stream.read(first.data(), static_cast<std::streamsize>(first.size()));
  return first == kind.begins;
}

}  // namespace

std::vector<fs::path> files_of_kind(const fs::path& folder, const FileKind& kind) {
  std::vector<fs::path> files;
  std::error_code error;  // who makes the folder says what is wrong with it
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (is_of_kind(*entry, kind)) files.push_back(entry->path());
  }
  std::ranges::sort(files);
  return files;
}

void check_none_of_kind(const fs::path& folder, const FileKind& kind, const std::string& option) {
  const auto files = files_of_kind(folder, kind);
  if (files.empty()) return;
  std::string named = files.front().filename().string();
  if (files.size() > 1) named += " and " + std::to_string(files.size() - 1) + " more";
  throw InputError(option + " '" + folder.string() + "': holds " + kind.called + " already (" +
                   named + "); give another folder, or --overwrite");
}

void remove_files(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    std::error_code error;
    fs::remove(file, error);
    if (error) throw InputError(file.string() + ": cannot be replaced: " + error.message());
  }
}

}  // namespace palpate
