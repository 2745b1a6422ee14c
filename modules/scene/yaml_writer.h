// Visitor of the schema (see schema.h) that writes a scene as YAML: every key, in the schema's
// order, with as many digits as it takes to read the same bits back.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "modules/scene/schema.h"
#include "modules/scene/value_text.h"

namespace palpate::scene {

class YamlWriter {
 public:
  enum class FileNames { kFull, kOnlyFormat };
  explicit YamlWriter(FileNames file_names) : file_names_(file_names) {}

  const std::string& text() const { return text_; }
  /// Every file named, in order.
  const std::vector<std::filesystem::path>& files() const { return files_; }

  void field(const char* key, double value, const About&) { line(key, number_text(value)); }
  void field(const char* key, std::size_t value, const About&) { line(key, std::to_string(value)); }
  void field(const char* key, bool value, const About&) { line(key, value ? "true" : "false"); }
  void field(const char* key, std::string& value, const About& about) {
    line(key, about.is_model ? value : quoted_text(value));
  }
  void field(const char* key, std::filesystem::path& value, const About&) {
    files_.push_back(value);
    const auto shown = file_names_ == FileNames::kFull ? value : value.extension();
    line(key, quoted_text(shown.string()));
  }
  void field(const char* key, Vec3& value, const About&) { line(key, list_text(value)); }
  void field(const char* key, Quat& value, const About&) { line(key, list_text(value)); }
  template <Enumeration Enum>
  void field(const char* key, Enum& value, const About&) {
    line(key, word_of(value));
  }
  template <class T>
  void field(const char* key, std::optional<T>& value, const About& about) {
    if (value) field(key, *value, about);
  }
  void field(const char* key, std::vector<std::string>& list, const About&) {
    std::string text;
    for (const auto& entry : list) text += (text.empty() ? "" : ", ") + quoted_text(entry);
    if (!list.empty()) line(key, "[" + text + "]");
  }
  template <class T>
  void field(const char* key, std::vector<T>& list, const About&) {
    if (list.empty()) return line(key, "[]");
    line(key, "");
    for (T& entry : list) {
      indent_ += 2;
      begins_entry_ = true;
      describe(*this, entry);
      indent_ -= 2;
    }
  }
  template <class T>
  void field(const char* key, T& object, const About&) {
    line(key, "");
    const std::size_t before = text_.size();
    indent_ += 2;
    describe(*this, object);
    indent_ -= 2;
    if (text_.size() > before) return;
    text_.pop_back();
    text_ += " {}\n";
  }
  template <class T, class Variant>
  void option(const char* key, Variant& variant, const About& about) {
    if (T* chosen = std::get_if<T>(&variant)) field(key, *chosen, about);
  }
  void require(bool, const char*) {}
  void fits(const char*, const Misfit&) {}
  template <class T>
  void unique_names(const char*, const std::vector<T>&) {}

 private:
  void line(const char* key, const std::string& value) {
    text_.append(begins_entry_ ? indent_ - 2 : indent_, ' ');
    if (begins_entry_) text_ += "- ";
    begins_entry_ = false;
    text_.append(key).append(value.empty() ? ":" : ": ").append(value).append("\n");
  }

  FileNames file_names_;
  std::string text_;
  std::vector<std::filesystem::path> files_;
  std::size_t indent_ = 0;
  bool begins_entry_ = false;  // the next line opens an entry of a list
};

}  // namespace palpate::scene
