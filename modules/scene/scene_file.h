// Scenes by name, and the scenes that are shipped.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::scene {

struct ShippedScene {
  std::string name;  ///< what `palpate run` takes: "stomach_probe"
  std::filesystem::path file;
  std::string meaning;  ///< the comment the file begins with, to its first full stop
};

/// Of the data folder, by name.
std::vector<ShippedScene> shipped_scenes();

/// The file that a command's SCENE means: itself if it exists, else the shipped scene of that name,
/// which a folder of its name, as an --out may be, does not hide.
/// @throws InputError where there is neither, or for a mesh
std::filesystem::path scene_file(const std::filesystem::path& named);
/// Whether it is a file of the data folder, where nothing is written.
bool is_shipped(const std::filesystem::path& file);

}  // namespace palpate::scene
