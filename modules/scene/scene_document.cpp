#include "modules/scene/scene_document.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "modules/scene/scene_error.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/scene_tree.h"
#include "modules/scene/value_text.h"

namespace palpate::scene {
namespace {

/// A key of a mapping or, with an empty one, an entry of a list.
struct PathPart {
  std::string key;
  std::size_t index = 0;
};

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& path,
                         const std::string& why) {
  throw SceneError(file.string(), 0, path, "key '" + shortened(path) + "' " + why);
}

/// "a.b[2].c" as a, b, 2, c.
std::vector<PathPart> parts_of(const std::string& path, const std::filesystem::path& file) {
  constexpr std::size_t kMostDigits = 6;
  std::vector<PathPart> parts;
  const auto bad = [&] { refuse(file, path, "is no path such as organs[0].tissue.drag_per_s"); };
  for (std::size_t at = 0; at < path.size();) {
    if (path[at] == '[' && !parts.empty()) {
      const std::size_t end = path.find(']', at);
      const std::string digits = end == std::string::npos ? "" : path.substr(at + 1, end - at - 1);
      if (digits.empty() || digits.size() > kMostDigits ||
          digits.find_first_not_of("0123456789") != std::string::npos)
        bad();
      parts.push_back({"", std::stoul(digits)});
      at = end + 1;
      continue;
    }
    if (!parts.empty() && path[at++] != '.') bad();
    const std::size_t end = std::min(path.find_first_of(".[", at), path.size());
    if (end == at) bad();
    parts.push_back({path.substr(at, end - at)});
    at = end;
  }
  if (parts.empty()) bad();
  return parts;
}

std::string plain_number(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
  return number_text(value);
}

YAML::Node node_of(const SceneValue& value);

/// Texts are quoted: one that looks like a number is none.
struct NodeMaker {
  YAML::Node operator()(std::monostate) const { return YAML::Node(YAML::NodeType::Null); }
  YAML::Node operator()(bool flag) const { return plain(flag ? "true" : "false"); }
  YAML::Node operator()(std::int64_t whole) const { return plain(std::to_string(whole)); }
  YAML::Node operator()(double number) const { return plain(plain_number(number)); }
  YAML::Node operator()(const std::string& text) const {
    YAML::Node node(text);
    node.SetTag("!");
    return node;
  }
  YAML::Node operator()(const SceneValue::List& list) const {
    YAML::Node node(YAML::NodeType::Sequence);
    for (const SceneValue& entry : list) node.push_back(node_of(entry));
    return node;
  }
  YAML::Node operator()(const SceneValue::Map& map) const {
    YAML::Node node(YAML::NodeType::Map);
    for (const auto& [key, value] : map) {
      if (!std::holds_alternative<std::monostate>(value.content)) node[key] = node_of(value);
    }
    return node;
  }
  static YAML::Node plain(const std::string& text) {
    YAML::Node node(text);
    node.SetTag("?");
    return node;
  }
};

YAML::Node node_of(const SceneValue& value) { return std::visit(NodeMaker(), value.content); }

/// Changes a tree below `node`, along the path's parts from `at` on.
class TreeChange {
 public:
  TreeChange(const SceneDocument::Change& change, const std::filesystem::path& file)
      : path_(change.first),
        file_(file),
        parts_(parts_of(path_, file)),
        removes_(std::holds_alternative<std::monostate>(change.second.content)),
        value_(node_of(change.second)) {}

  void apply(YAML::Node node, std::size_t at = 0) const {
    const PathPart& part = parts_[at];
    return part.key.empty() ? apply_to_list(node, at) : apply_to_map(node, at);
  }

 private:
  bool last(std::size_t at) const { return at + 1 == parts_.size(); }

  void apply_to_map(YAML::Node node, std::size_t at) const {
    if (!node.IsMap()) refuse(file_, path_, "is not there: what would hold it is no mapping");
    const std::string& key = parts_[at].key;
    if (last(at) && removes_) {
      node.remove(key);
    } else if (last(at)) {
      node[key] = value_;
    } else {
      if (!node[key].IsDefined() || node[key].IsNull()) {
        if (removes_) return;
        const bool list = parts_[at + 1].key.empty();
        node[key] = YAML::Node(list ? YAML::NodeType::Sequence : YAML::NodeType::Map);
      }
      apply(node[key], at + 1);
    }
  }

  void apply_to_list(YAML::Node node, std::size_t at) const {
    const std::size_t index = parts_[at].index;
    if (!node.IsSequence() || index > node.size() || (index == node.size() && removes_))
      refuse(file_, path_, "is not there: the list has no entry " + std::to_string(index));
    if (index == node.size())
      node.push_back(last(at) ? value_ : YAML::Node(YAML::NodeType::Map));
    else if (last(at) && removes_)
      node.remove(index);
    else if (last(at))
      node[index] = value_;
    if (!last(at)) apply(node[index], at + 1);
  }

  const std::string& path_;
  const std::filesystem::path& file_;
  std::vector<PathPart> parts_;
  bool removes_;
  YAML::Node value_;
};

std::string text_in(const std::filesystem::path& file) {
  load_scene(file);  // says what is wrong with it
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// Whether setting `path` leaves nothing of what `earlier` set: it is the same, or holds it.
bool replaces(const std::string& path, const std::string& earlier) {
  if (!earlier.starts_with(path)) return false;
  return earlier.size() == path.size() || earlier[path.size()] == '.' ||
         earlier[path.size()] == '[';
}

}  // namespace

SceneDocument::SceneDocument(const std::filesystem::path& file)
    : SceneDocument(text_in(file), file) {}

SceneDocument::SceneDocument(std::string text, std::filesystem::path file)
    : text_(std::move(text)), file_(std::move(file)), scene_(parse_scene(text_, file_)) {
  // Two places that share a node by an anchor would change together.
  if (text_.find('&') != std::string::npos) text_ = resolved_text(scene_);
}

void SceneDocument::change(std::span<const Change> changes) {
  std::vector<Change> all = changes_;
  for (const Change& change : changes) {
    // Where an entry was taken out of a list, the same path means another one.
    const bool moved =
        std::ranges::any_of(all, [](const Change& c) { return c.first.ends_with(']'); });
    if (!moved)
      std::erase_if(all, [&](const Change& c) { return replaces(change.first, c.first); });
    all.push_back(change);
  }
  YAML::Node tree = parse_yaml(text_, {file_.string(), file_.parent_path()});
  for (const Change& change : all) TreeChange(change, file_).apply(tree);
  scene_ = scene_from(tree, file_);
  changes_ = std::move(all);
}

SceneValue SceneDocument::value(const std::string& path) const {
  SceneValue all = value_of(scene_);
  if (path.empty()) return all;
  const SceneValue* at = &all;
  for (const PathPart& part : parts_of(path, file_)) {
    const auto* map = std::get_if<SceneValue::Map>(&at->content);
    const auto* list = std::get_if<SceneValue::List>(&at->content);
    at = nullptr;
    if (part.key.empty() && list != nullptr && part.index < list->size()) at = &(*list)[part.index];
    if (!part.key.empty() && map != nullptr) {
      const auto found = std::ranges::find(*map, part.key, &SceneValue::Map::value_type::first);
      if (found != map->end()) at = &found->second;
    }
    if (at == nullptr) refuse(file_, path, "is not there");
  }
  return *at;
}

}  // namespace palpate::scene
