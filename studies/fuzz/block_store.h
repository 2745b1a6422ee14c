// Outcomes of earlier runs, one file per block of scenes, which appears whole or not at all.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <vector>

#include "studies/fuzz/outcome.h"
#include "studies/report/point_files.h"

namespace palpate::fuzz {

inline constexpr std::uint64_t kBlock = 100;  ///< scenes

class BlockStore {
 public:
  /// @param folder  made if need be
  /// @param log     told of blocks that are not whole
  BlockStore(const std::filesystem::path& folder, std::uint64_t seed, std::ostream& log);

  /// @returns false if the block is not there, of another version of this program, or not whole
  bool read(std::uint64_t first, std::size_t count, std::vector<Outcome>& out) const;
  void write(std::uint64_t first, const std::vector<Outcome>& outcomes) const;
  /// A word for the block, in all runs that would run the same.
  std::string key(std::uint64_t first, std::size_t count) const { return name_of(first, count); }

 private:
  std::string name_of(std::uint64_t first, std::size_t count) const;

  report::PointFiles files_;
  std::uint64_t seed_;
};

}  // namespace palpate::fuzz
