// `palpate new`: a scene from a mesh, ready to be run and then changed.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

namespace palpate::launcher {

struct NewOptions {
  std::filesystem::path mesh;
  std::filesystem::path output;  ///< scene to write; empty: the mesh's name with .yaml, here
  std::string unit;              ///< of the mesh; empty: guessed, and said
};

/// Looks at the mesh, guesses its unit if none is given, fixes its back, puts a sphere before its
/// front that presses and lets go, and writes that as a scene with comments.
/// @return an exit code of core/error.h
/// @throws InputError for a mesh that cannot be used, or a scene file that is there already
int new_command(const NewOptions& options, std::ostream& out);

}  // namespace palpate::launcher
