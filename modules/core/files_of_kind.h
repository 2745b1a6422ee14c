// Folders that get many files of a kind: pictures of a run, tables of a recording. What an earlier
// run or recording left there would be taken for a part of the new one.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// How they are told from other files.
struct FileKind {
  std::string_view name_begins, extension;  ///< of their names: "frame_", ".png"
  std::string_view begins;                  ///< their first bytes
  const char* called;                       ///< for messages: "pictures of a run"
};

/// Those of a folder in the order of their names; none of one that is not there.
std::vector<std::filesystem::path> files_of_kind(const std::filesystem::path& folder,
                                                 const FileKind& kind);

/// @param option  that asks for the folder, "--frames"
/// @throws InputError naming one if there is any
void check_none_of_kind(const std::filesystem::path& folder, const FileKind& kind,
                        const std::string& option);

/// @throws InputError naming one that cannot be deleted
void remove_files(const std::vector<std::filesystem::path>& files);

}  // namespace palpate
