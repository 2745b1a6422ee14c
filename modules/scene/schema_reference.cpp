#include "modules/scene/schema_reference.h"

#include <optional>
#include <variant>
#include <vector>

#include "modules/core/error.h"
#include "modules/scene/object_reader.h"
#include "modules/scene/schema.h"
#include "modules/scene/value_text.h"

namespace palpate::scene {
namespace {

/// Visitor of the schema (see schema.h) that writes the table of one object, and of the objects
/// below it after it.
class SchemaTable {
 public:
  explicit SchemaTable(std::string path) : path_(std::move(path)) {}

  void field(const char* key, double& value, const About& about) {
    row(key, "number", about, number_text(value));
  }
  void field(const char* key, std::size_t& value, const About& about) {
    row(key, "whole number", about, std::to_string(value));
  }
  void field(const char* key, bool& value, const About& about) {
    row(key, "true or false", about, value ? "true" : "false");
  }
  void field(const char* key, std::string& value, const About& about) {
    row(key, about.is_model ? model_words() : "text", about, value);
  }
  void field(const char* key, std::filesystem::path&, const About& about) {
    row(key, "file", about, "");
  }
  void field(const char* key, Vec3& value, const About& about) {
    row(key, "[x, y, z]", about, list_text(value));
  }
  void field(const char* key, Quat& value, const About& about) {
    row(key, "[x, y, z, w]", about, list_text(value));
  }
  template <Enumeration Enum>
  void field(const char* key, Enum& value, const About& about) {
    std::string words;
    for (const char* word : Words<Enum>::texts) {
      words += words.empty() ? "" : ", ";
      words += word;
    }
    row(key, words, about, word_of(value));
  }
  template <class T>
  void field(const char* key, std::optional<T>&, const About& about) {
    T value{};
    field(key, value, about);
  }
  void field(const char* key, std::vector<std::string>&, const About& about) {
    row(key, "list of texts", about, "");
  }
  template <class T>
  void field(const char* key, std::vector<T>&, const About& about) {
    row(key, "list", about, "[]");
    T entry;
    object_below(std::string(key) + "[]", entry);
  }
  template <class T>
  void field(const char* key, T& object, const About& about) {
    row(key, "keys", about, "as below");
    object_below(key, object);
  }
  template <class T, class Variant>
  void option(const char* key, Variant&, const About& about) {
    choose_one_ = true;
    T object;
    row(key, "keys", about, "");
    object_below(key, object);
  }
  void require(bool, const char* rule) { rules_ += std::string("\nRule: ") + rule + ".\n"; }
  void fits(const char* rule, const Misfit&) { require(true, rule); }
  template <class T>
  void unique_names(const char* key, const std::vector<T>&) {
    rules_ += std::string("\nRule: no two `") + key + "` have the same name; at most " +
              std::to_string(kMaxKeys) + ".\n";
  }

  std::string text() const {
    if (rows_.empty()) return "";
    const std::string title = path_.empty() ? "The scene" : "`" + path_ + "`";
    return "### " + title + "\n\n" + (choose_one_ ? "Exactly one of these keys.\n\n" : "") +
           "| key | type | unit | range | default | meaning |\n|---|---|---|---|---|---|\n" +
           rows_ + rules_ + "\n" + below_;
  }

 private:
  template <class T>
  void object_below(const std::string& key, T& object) {
    SchemaTable table(path_.empty() ? key : path_ + "." + key);
    describe(table, object);
    below_ += table.text();
  }

  void row(const std::string& key, const std::string& type, const About& about,
           const std::string& default_value) {
    std::string range;
    if (about.min == about.max) {
      range = number_text(about.min);
    } else if (about.min > -std::numeric_limits<double>::infinity()) {
      range = number_text(about.min) + " … " + number_text(about.max);
    }
    std::string otherwise = default_value.empty() ? "" : "`" + default_value + "`";
    if (about.default_text) otherwise = about.default_text;
    if (default_value == "as below") otherwise = default_value;
    if (about.required) otherwise = "required";
    rows_ += "| `" + key + "` | " + type + " | " + about.unit + " | " + range + " | " + otherwise +
             " | " + about.meaning + " |\n";
  }

  std::string path_, rows_, rules_, below_;
  bool choose_one_ = false;
};

std::string reads(const ModelFormat& format) {
  std::string keys = format.is_solid() ? "solid" : "springs, filling, wall thickness";
  if (!format.is_solid() || format.has_modes) keys += ", damping ratio";
  if (format.has_integrator) keys += ", integrator";
  if (format.has_volume_corrections) keys += ", volume_corrections";
  if (format.iterations > 0) {
    keys += ", iterations (" + std::to_string(format.iterations) + " " + format.iterates + ")";
  }
  if (format.has_modes) keys += ", modes";
  return keys;
}

std::string model_reference() {
  std::string text =
      "### Models\n\n| model | what it is | nodes joined by | reads, beside what all read |\n"
      "|---|---|---|---|\n";
  for (const ModelFormat& format : model_formats()) {
    text += std::string("| `") + format.word + "` | " + format.meaning + " | " +
            (format.is_quadratic() ? "quadratic tetrahedra"
             : format.is_solid()   ? "linear tetrahedra"
                                   : "springs on the surface") +
            " | " + reads(format) + " |\n";
  }
  return text + "\n";
}

}  // namespace

std::string schema_reference() {
  SchemaTable table("");
  Scene scene;
  describe(table, scene);
  return table.text() + model_reference();
}

}  // namespace palpate::scene
