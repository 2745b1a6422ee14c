#include "modules/scene/object_reader.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "modules/scene/scene_error.h"

namespace palpate::scene {
namespace {

std::string joined(const std::vector<std::string>& texts) {
  std::string result;
  for (const auto& text : texts) result += (result.empty() ? "" : ", ") + text;
  return result;
}

/// Fewest single-character changes from one text to the other (Levenshtein 1966).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t k = 1; k <= b.size(); ++k) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[k - 1] ? 0 : 1);
      diagonal = row[k];
      row[k] = std::min({replaced, row[k] + 1, row[k - 1] + 1});
    }
  }
  return row.back();
}

/// The candidate a person may have meant: one that begins alike (a forgotten unit), or the one with
/// the fewest changes if they are at most half of the longer text; else empty.
std::string nearest(const std::string& text, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t fewest = std::string::npos;
  for (const auto& candidate : candidates) {
    const bool begins_alike =
        text.size() > 2 && (candidate.starts_with(text) || text.starts_with(candidate));
    const std::size_t changes = begins_alike ? 1 : edit_distance(text, candidate);
    if (changes < fewest && 2 * changes <= std::max(text.size(), candidate.size())) {
      best = candidate;
      fewest = changes;
    }
  }
  return best;
}

}  // namespace

ObjectReader::ObjectReader(const YamlValue& object, const KeyList& allowed) : object_(object) {
  if (!object_.node.IsMap()) {
    object_.refuse(allowed.keys.empty() ? "must be {}"
                                        : "must hold keys, out of: " + joined(allowed.keys));
  }
  check_keys(allowed);
  if (allowed.choose_one) check_options(allowed);
  for (const auto& key : allowed.required) {
    if (!find(key)) {
      throw SceneError(object_.source->name, object_.line, object_.key_below(key),
                       "key '" + object_.key_below(key) + "' is missing");
    }
  }
}

void ObjectReader::check_keys(const KeyList& allowed) const {
  std::set<std::string> seen;
  for (const auto& entry : object_.node) {
    if (!entry.first.IsScalar()) {
      throw SceneError(object_.source->name, line_of(entry.first, object_.line), object_.key,
                       "a key of '" + object_.key + "' is not a plain word");
    }
    const std::string& key = entry.first.Scalar();
    if (std::find(allowed.keys.begin(), allowed.keys.end(), key) == allowed.keys.end()) {
      refuse_key(entry.first, allowed);
    }
    if (!seen.insert(key).second) {
      throw SceneError(object_.source->name, line_of(entry.first, object_.line),
                       object_.key_below(key),
                       "key '" + object_.key_below(key) + "' is given twice");
    }
  }
}

void ObjectReader::check_options(const KeyList& allowed) const {
  if (object_.node.size() != 1) {
    object_.refuse("must hold exactly one of: " + joined(allowed.keys));
  }
}

void ObjectReader::refuse_key(const YAML::Node& key, const KeyList& allowed) const {
  const std::string full = object_.key_below(shortened(key.Scalar()));
  std::string message = "key '" + full + "' is not known";
  const std::string meant = nearest(key.Scalar(), allowed.keys);
  message += meant.empty() ? "." : "; did you mean '" + meant + "'?";
  message += allowed.keys.empty() ? " None is allowed here" : " Allowed: " + joined(allowed.keys);
  throw SceneError(object_.source->name, line_of(key, object_.line), full, message);
}

void ObjectReader::refuse_many(const char* key, std::size_t count) const {
  find(key)->refuse("must have at most " + std::to_string(kMaxKeys) + " entries, has " +
                    std::to_string(count));
}

void ObjectReader::refuse_name(const char* key, std::size_t index, std::size_t same_as,
                               const std::string& name) const {
  const auto list = find(key);
  const std::string prefix = list->key + "[";
  const std::string full = prefix + std::to_string(index) + "].name";
  throw SceneError(object_.source->name, line_of(list->node[index], list->line), full,
                   "key '" + full + "' = '" + name + "': must be unique, but is the name of " +
                       prefix + std::to_string(same_as) + "] too");
}

YamlValue ObjectReader::value_at(const std::string& path) const {
  const auto dot = path.find('.');
  const std::string name = path.substr(0, dot);
  const auto bracket = name.find('[');
  auto value = find(name.substr(0, bracket));
  if (!value) return object_;
  if (bracket != std::string::npos) {
    value = entries_of(*value).at(std::stoul(name.substr(bracket + 1)));
  }
  if (dot == std::string::npos) return *value;
  ObjectReader below(*this);
  below.object_ = *value;
  return below.value_at(path.substr(dot + 1));
}

std::optional<YamlValue> ObjectReader::find(const std::string& key) const {
  for (const auto& entry : object_.node) {
    if (entry.first.Scalar() == key) {
      return YamlValue{entry.second, line_of(entry.first, object_.line), object_.key_below(key),
                       object_.source};
    }
  }
  return std::nullopt;
}

}  // namespace palpate::scene
