// A scene that cannot be accepted, with the place: what a program shows in one line and a caller
// may ask for.
#pragma once

#include "modules/core/error.h"

namespace palpate::scene {

struct SceneError : InputError {
  /// Without a line (0) where the file as a whole is meant.
  SceneError(const std::string& file_in, int line_in, std::string key_in,
             const std::string& problem)
      : InputError(file_in + (line_in > 0 ? ":" + std::to_string(line_in) : "") + ": " + problem),
        file(file_in),
        line(line_in),
        key(std::move(key_in)) {}

  std::string file;
  int line;         ///< from 1
  std::string key;  ///< full, "organs[0].tissue.drag_per_s"; empty: none
};

}  // namespace palpate::scene
