// A mesh file that a scene names.
#pragma once

#include <filesystem>
#include <string>

namespace palpate::scene {

struct Mesh {
  std::filesystem::path file;  ///< key `file`; relative to the scene file. Absolute after loading
  std::string unit = "m";      ///< key `unit`: m, dm, cm, mm, um, in
  std::size_t nodes = 0;       ///< key `nodes`: resample to this count, 0 = as it is [0 … 200000]
};

}  // namespace palpate::scene
