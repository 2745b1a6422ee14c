// Whether a file can be read, asked before it is opened: a FIFO would be waited for, a device has
// no end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace palpate {

/// Why it cannot: there is none, it is a folder, a FIFO or a device, or closed to us; empty if it
/// can.
std::string why_not_readable(const std::filesystem::path& file);

/// For bytes as they are. @throws InputError naming file and reason
std::ifstream open_input(const std::filesystem::path& file);

/// Before all of it is taken into memory. @throws InputError as open_input(), and for a longer file
void check_input(const std::filesystem::path& file, std::uintmax_t most_bytes);

/// All of it. @throws InputError as check_input()
std::string read_input(const std::filesystem::path& file, std::uintmax_t most_bytes);

}  // namespace palpate
