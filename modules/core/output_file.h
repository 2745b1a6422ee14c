// Whether a file can be written, asked before the work is done that ends in it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// Why it cannot: its folder is missing, closed to us or takes no file (what is written whole comes
/// to be beside its place), or it is there, and is a folder or closed; empty if it can.
std::string why_not_writable(const std::filesystem::path& file);

/// Whether the error says that there is no room: a full disk, a quota or a limit on the size of
/// files. That is a failure, not bad input.
bool is_disk_full(int system_error);

/// @throws InputError naming file and reason
void check_writable(const std::filesystem::path& file);

/// Made if it is not there. @throws InputError naming the option that asks for it
void make_writable_folder(const std::filesystem::path& folder, const std::string& option);

/// For a file that is written anew each time: it may replace only its like, which begins with the
/// same words, or an empty file; and no FIFO or device.
/// @param kind  of it, for the message: "summary"
/// @throws InputError naming file and reason
void check_replaces_its_like(const std::filesystem::path& file, std::string_view beginning,
                             const std::string& kind);

}  // namespace palpate
