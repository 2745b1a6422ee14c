// Bags of the tests' folder, and what every reader of bags has to bear.
#pragma once

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "modules/core/error.h"
#include "modules/trajectories/trajectory_file.h"
#include "tests/scratch_folder.h"

namespace palpate::trajectories::testing {

inline const std::filesystem::path kBags =
    std::filesystem::path(PALPATE_SOURCE_DIR) / "tests/modules/trajectories/bags";

/// The error of a file that is refused; else "accepted".
inline std::string bag_error(const scene::TrajectoryDevice& config) {
  std::vector<std::string> warnings;
  try {
    read_trajectory(config, warnings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// Reads the first bytes of a bag of 50 poses. Oracle: the bytes left out.
/// @returns the one warning
inline std::string warning_of_cut(const std::string& bag, std::size_t bytes) {
  const ScratchFolder folder;
  const scene::TrajectoryDevice config{
      .file = folder.write("cut_" + bag, text_in(kBags / bag).substr(0, bytes))};
  std::vector<std::string> warnings;
  const auto poses = read_trajectory(config, warnings);
  CHECK(poses.size() >= 2);
  CHECK(poses.size() < 50);
  REQUIRE(warnings.size() == 1);
  return warnings[0];
}

/// Reads a bag with one byte spoiled, again and again. Oracle: none but the sanitizers and this:
/// poses or an InputError, and both happen.
inline void check_spoiled(const std::string& bag) {
  const ScratchFolder folder;
  const std::string whole = text_in(kBags / bag);
  std::size_t refused = 0, read = 0;
  for (std::size_t i = 0; i < whole.size(); i += 97) {
    std::string spoiled = whole;
    spoiled[i] = char(~spoiled[i]);
    const auto said = bag_error({.file = folder.write("spoiled_" + bag, spoiled)});
    (said == "accepted" ? read : refused) += 1;
  }
  CHECK(refused > 0);
  CHECK(read > 0);
}

}  // namespace palpate::trajectories::testing
