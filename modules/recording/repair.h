// A recording that is torn or damaged, written anew: whole, with its indexes.
#pragma once

#include <cstdint>
#include <filesystem>

namespace palpate::recording {

struct RepairReport {
  std::uint64_t samples = 0;
  std::uint64_t skipped = 0;  ///< damaged chunks and other records, left out
  bool torn = false;          ///< it had no regular end
};

/// Writes what can be read of one file to another.
/// @throws InputError if `damaged` is not an MCAP file, or `repaired` is there already;
/// std::runtime_error as McapWriter does
RepairReport repair(const std::filesystem::path& damaged, const std::filesystem::path& repaired);

}  // namespace palpate::recording
