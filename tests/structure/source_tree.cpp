#include "tests/structure/source_tree.h"

#include <algorithm>
#include <fstream>
#include <regex>

namespace palpate::structure {

namespace fs = std::filesystem;

const fs::path& root() {
  static const fs::path kRoot = PALPATE_SOURCE_DIR;
  return kRoot;
}

const std::vector<std::string>& code_folders() {
  static const std::vector<std::string> kFolders{
      "modules", "deformation", "collision", "haptics", "visualizer",
      "palpate", "studies",     "bench",     "scenes",  "python"};
  return kFolders;
}

std::vector<std::string> sources(const std::string& folder) {
  std::vector<std::string> files;
  if (!fs::exists(root() / folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(root() / folder)) {
    const auto extension = entry.path().extension();
    if (extension == ".h" || extension == ".cpp") {
      files.push_back(fs::relative(entry.path(), root()).string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> code() {
  std::vector<std::string> files;
  for (const auto& folder : code_folders()) {
    const auto found = sources(folder);
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

std::vector<std::string> lines_of(const std::string& file) {
  std::vector<std::string> lines;
  std::ifstream stream(root() / file);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<Include> includes_of(const std::string& file) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> includes;
  std::size_t number = 0;
  for (const auto& line : lines_of(file)) {
    ++number;
    std::smatch match;
    if (line.find("include") == std::string::npos) continue;
    if (std::regex_search(line, match, kInclude)) includes.push_back({file, number, match[1]});
  }
  return includes;
}

bool is_wiring(const std::string& file) {
  static const std::regex kWiring(R"((/(stage|organ_messages|organ_inputs)\.(h|cpp)|main\.cpp)$)");
  return std::regex_search(file, kWiring);
}

std::string layer_of(const std::string& path) {
  if (path.starts_with("modules/recording/mcap_")) return "mcap";  // a library of its own
  if (path.starts_with("modules/")) return path.substr(8, path.find('/', 8) - 8);
  if (path.starts_with("palpate/session/")) return "session";
  if (path.starts_with("scenes/meshes/")) return "meshes";
  const std::string top = path.substr(0, path.find('/'));
  const auto& folders = code_folders();
  const bool ours = top == "tests" || std::count(folders.begin(), folders.end(), top) > 0;
  return ours && top != path ? top : "";
}

}  // namespace palpate::structure
