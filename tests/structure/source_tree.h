// The project's own code as text: files and what they include.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::structure {

struct Include {
  std::string file;    ///< tree-relative
  std::size_t line;    ///< from 1
  std::string header;  ///< as written, without <> or ""
};

/// The source tree.
const std::filesystem::path& root();

/// Folders of everything that is not a test.
const std::vector<std::string>& code_folders();

/// Names, relative to the tree, of .h and .cpp files under `folder`.
std::vector<std::string> sources(const std::string& folder);

/// Of all code folders.
std::vector<std::string> code();

std::vector<Include> includes_of(const std::string& file);

std::vector<std::string> lines_of(const std::string& file);

/// Stages, processes and mains name the parts of a process: they may know what they wire.
bool is_wiring(const std::string& file);

/// "modules/bus/…" is "bus", "palpate/session/…" "session", "scenes/meshes/…" "meshes", else the
/// top folder; empty for foreign headers.
std::string layer_of(const std::string& path);

}  // namespace palpate::structure
