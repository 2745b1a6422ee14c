// Whether a file can be written, asked before the work is done that ends in it.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// Why it cannot: its folder is missing or closed to us, or it is there, and is a folder or closed;
/// empty if it can.
std::string why_not_writable(const std::filesystem::path& file);

/// @throws InputError naming file and reason
void check_writable(const std::filesystem::path& file);

}  // namespace palpate
