// Outcomes of earlier runs, one file per block of scenes, which appears whole or not at all.
#pragma once

#include <filesystem>
#include <vector>

#include "studies/fuzz/outcome.h"

namespace palpate::fuzz {

inline constexpr std::uint64_t kBlock = 100;  ///< scenes

class BlockStore {
 public:
  /// @param folder  made if need be
  BlockStore(std::filesystem::path folder, std::uint64_t seed);

  /// @returns false if the block is not there, or is of another version of this program
  bool read(std::uint64_t first, std::size_t count, std::vector<Outcome>& out) const;
  void write(std::uint64_t first, const std::vector<Outcome>& outcomes) const;
  /// A word for the block, in all runs that would run the same.
  std::string key(std::uint64_t first, std::size_t count) const {
    return file_of(first, count).stem().string();
  }

 private:
  std::filesystem::path file_of(std::uint64_t first, std::size_t count) const;

  std::filesystem::path folder_;
  std::uint64_t seed_;
};

}  // namespace palpate::fuzz
