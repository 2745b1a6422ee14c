#include "palpate/list_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ostream>

#include "modules/core/error.h"
#include "modules/scene/key_list.h"
#include "modules/scene/models.h"
#include "modules/scene/scene_file.h"

namespace palpate::launcher {
namespace {

struct Line {
  std::string word, meaning;
};

std::vector<Line> options_of(const scene::KeyList& keys) {
  std::vector<Line> lines;
  for (std::size_t i = 0; i < keys.keys.size(); ++i) {
    lines.push_back({keys.keys[i], keys.meanings[i]});
  }
  return lines;
}

std::vector<Line> lines_of(const std::string& kind) {
  std::vector<Line> lines;
  if (kind == "scenes") {
    for (const auto& scene : scene::shipped_scenes()) lines.push_back({scene.name, scene.meaning});
  } else if (kind == "models") {
    for (const auto& model : scene::model_formats()) lines.push_back({model.word, model.meaning});
  } else if (kind == "shapes") {
    lines = options_of(scene::keys_of<scene::ProbeShape>());
  } else {
    lines = options_of(scene::keys_of<scene::Device>());
  }
  return lines;
}

const char* hint(const std::string& kind) {
  if (kind == "scenes") return "palpate run NAME";
  if (kind == "models") return "key `model` of an organ";
  if (kind == "shapes") return "key `shape` of a probe";
  return "key `device` of a probe";
}

}  // namespace

const std::vector<std::string>& list_kinds() {
  static const std::vector<std::string> kKinds{"scenes", "models", "shapes", "devices"};
  return kKinds;
}

int list_command(const std::string& kind, std::ostream& out) {
  for (const auto& each : list_kinds()) {
    if (!kind.empty() && kind != each) continue;
    const auto lines = lines_of(each);
    std::size_t width = 0;
    for (const auto& line : lines) width = std::max(width, line.word.size());
    out << fmt::format("{} ({})\n", each, hint(each));
    for (const auto& line : lines)
      out << fmt::format("  {:<{}}  {}\n", line.word, width, line.meaning);
    if (kind.empty() && each != list_kinds().back()) out << '\n';
  }
  return kExitDone;
}

}  // namespace palpate::launcher
