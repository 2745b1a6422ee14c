// Programs of node that judge recordings, where node and the packages of scripts/node_modules are.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

namespace palpate::testing {

inline constexpr const char* kNoNode =
    "SKIPPED: node, or the packages that scripts/node_modules gets, are missing\n";

inline std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string output;
  char buffer[4096];
  while (pipe && std::fgets(buffer, sizeof buffer, pipe.get())) output += buffer;
  return output;
}

/// Folder node_modules with the packages of scripts/node_modules; empty if there is none.
inline std::string node_modules() {
  if (output_of("node --version 2>/dev/null").empty()) return {};
  const char* named = std::getenv("PALPATE_NODE_MODULES");
  const std::filesystem::path folder =
      named != nullptr ? named : PALPATE_SOURCE_DIR "/out/node_modules";
  for (const char* package : {"@mcap/core", "fzstd", "@foxglove/schemas"}) {
    if (!std::filesystem::exists(folder / package)) return {};
  }
  return folder.string();
}

/// What a script of this folder says of a file.
inline std::string judged_by(const std::string& script, const std::filesystem::path& file,
                             const std::string& modules) {
  return output_of("node " PALPATE_SOURCE_DIR "/tests/modules/recording/" + script + " " +
                   file.string() + " " + modules + " 2>&1");
}

}  // namespace palpate::testing
