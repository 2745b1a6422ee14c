// `palpate fuzz`: random scenes, looking for one that fails without a guard noticing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>

#include "studies/report/claims.h"

namespace palpate::fuzz {

inline constexpr double kMostScenes = 1e7, kLargestSeed = 1e18;

struct FuzzOptions {
  std::filesystem::path out = "out/fuzz";
  std::uint64_t scenes = 1000, seed = 1;
  std::optional<std::uint64_t> only;        ///< this scene alone, in detail
  bool again = false;                       ///< runs anew what has been run
  std::optional<report::Shard> shard = {};  ///< runs blocks that no other does
};

/// The whole command. Each failing scene is minimised and left in out/scene_k; blocks of finished
/// scenes stay in out/blocks and are not run again.
/// @return an exit code of core/error.h: failed if any scene did; 130 if it was stopped
/// @throws InputError if a mesh or gmsh is not there
int run_fuzz(const FuzzOptions& options, std::ostream& out, std::ostream& log);

}  // namespace palpate::fuzz
