// A recording that is torn or damaged, written anew: whole, in one part, with its indexes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::recording {

struct RepairReport {
  std::uint64_t samples = 0;
  std::uint64_t skipped = 0;               ///< damaged chunks and other records, left out
  std::uint64_t samples_left_out = 0;      ///< of types or topics that are not known any more
  std::uint64_t mended = 0;                ///< types and topics, from their copies in the summary
  bool torn = false;                       ///< one of its parts had no regular end
  int parts = 0;                           ///< taken
  std::vector<std::string> warnings = {};  ///< a line for each part, type and topic not taken
};

/// Writes what can be read of a recording, all of its parts, to another file. Of one of this
/// version it is read again: there is a file that can be read, or none.
/// @throws InputError if `damaged` is not an MCAP file, or beyond repair, or `repaired` is there
/// already;
/// std::runtime_error as McapWriter does
RepairReport repair(const std::filesystem::path& damaged, const std::filesystem::path& repaired);

}  // namespace palpate::recording
