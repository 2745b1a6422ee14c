#include "modules/scene/yaml_value.h"

#include <yaml-cpp/depthguard.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/core/text.h"
#include "modules/core/tolerances.h"
#include "modules/core/units.h"
#include "modules/scene/scene_error.h"
#include "modules/scene/value_text.h"

namespace palpate::scene {
namespace {

constexpr std::size_t kLongestShown = 60;    // bytes of a value repeated in a message
constexpr std::size_t kLongestText = 255;    // bytes of a name
constexpr double kNormalisedWithin = 1e-14;  // of its square: more is left by one normalisation

std::string shown(const YAML::Node& node) {
  std::string text;
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      text = node.Scalar();
      break;
    case YAML::NodeType::Sequence:
      for (const auto& entry : node) {
        text += (text.empty() ? "" : ", ") + (entry.IsScalar() ? entry.Scalar() : "…");
      }
      text = "[" + text + "]";
      break;
    case YAML::NodeType::Map:
      text = node.size() == 0 ? "{}" : "{…}";
      break;
    default:
      text = "null";
  }
  return shortened(text);
}

std::string with_unit(const About& about) {
  return *about.unit == '\0' ? "" : std::string(" ") + about.unit;
}

std::string range_text(const About& about) {
  if (about.min == about.max) return number_text(about.min);
  return "between " + number_text(about.min) + " and " + number_text(about.max) + with_unit(about);
}

bool is_plain_scalar(const YAML::Node& node) { return node.IsScalar() && node.Tag() != "!"; }

/// A finite number in decimal notation.
double parse_number(const YamlValue& value, const YAML::Node& node, const std::string& type) {
  if (!is_plain_scalar(node)) value.refuse("must be " + type);
  const std::string& text = node.Scalar();
  const char* first = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* last = text.data() + text.size();
  double number = 0;
  const auto [end, error] = std::from_chars(first, last, number);
  const bool is_yaml_special = text.find_first_of("0123456789") == std::string::npos &&
                               (text.ends_with("inf") || text.ends_with("Inf") ||
                                text.ends_with("INF") || text == ".nan" || text == ".NaN");
  if (is_yaml_special) value.refuse("must be finite");
  if (end != last || error == std::errc::invalid_argument) value.refuse("must be " + type);
  if (error != std::errc() || !std::isfinite(number)) value.refuse("must be finite");
  return number;
}

void check_range(const YamlValue& value, double number, const About& about, const char* what) {
  if (number < about.min || number > about.max) value.refuse(what + range_text(about));
}

}  // namespace

std::string shortened(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  if (text.size() <= kLongestShown) return text;
  return std::string(cut_at_letter(text, kLongestShown)) + "…";
}

std::string why_not_yaml(const YAML::Exception& error) {
  if (error.msg == YAML::ErrorMsg::DOC_IN_SCALAR) return "a quoted text is not closed";
  if (dynamic_cast<const YAML::DeepRecursion*>(&error) != nullptr) return "nested too deep";
  return error.msg;
}

int line_of(const YAML::Node& node, int otherwise) {
  return node.Mark().line < 0 ? otherwise : node.Mark().line + 1;
}

std::string YamlValue::key_below(const std::string& name) const {
  return key.empty() ? name : key + "." + name;
}

void YamlValue::refuse(const std::string& must) const {
  const std::string subject =
      key.empty() ? "the scene" : "key '" + key + "' = '" + shown(node) + "'";
  throw SceneError(source->name, line, key, subject + ": " + must);
}

double number_from(const YamlValue& value, const About& about) {
  const double number = parse_number(value, value.node, "a number");
  check_range(value, number, about, "must be ");
  return number;
}

std::size_t count_from(const YamlValue& value, const About& about) {
  const double number = parse_number(value, value.node, "a whole number");
  check_range(value, number, about, "must be ");
  if (number != std::floor(number)) value.refuse("must be a whole number");
  return static_cast<std::size_t>(number);
}

bool flag_from(const YamlValue& value) {
  if (is_plain_scalar(value.node) && value.node.Scalar() == "true") return true;
  if (is_plain_scalar(value.node) && value.node.Scalar() == "false") return false;
  value.refuse("must be true or false");
}

void check_name(const YamlValue& value, const std::string& text) {
  bool good = !text.empty() && text.size() <= kLongestText;
  if (!good || has_control_bytes(text))
    value.refuse("must be a text of 1 to 255 bytes without control characters");
  if (!is_utf8(text)) value.refuse("must be UTF-8");
}

std::string text_from(const YamlValue& value, const About& about) {
  if (!value.node.IsScalar()) value.refuse("must be a text");
  const std::string& text = value.node.Scalar();
  if (about.is_model) {
    const auto is_it = [&](const ModelFormat& format) { return text == format.word; };
    if (!std::ranges::any_of(model_formats(), is_it)) {
      value.refuse("must be one of: " + model_words());
    }
  }
  check_name(value, text);
  if (about.is_length_unit) {
    try {
      metres_per_unit(text);
    } catch (const InputError& error) {
      value.refuse(error.what());
    }
  }
  return text;
}

std::size_t word_from(const YamlValue& value, std::span<const char* const> words) {
  std::string allowed;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (value.node.IsScalar() && value.node.Scalar() == words[i]) return i;
    allowed += allowed.empty() ? "" : ", ";
    allowed += words[i];
  }
  value.refuse("must be one of: " + allowed);
}

Vec3 vector_from(const YamlValue& value, const About& about) {
  if (!value.node.IsSequence() || value.node.size() != 3) {
    value.refuse("must be a list of 3 numbers [x, y, z]");
  }
  Vec3 result;
  for (int i = 0; i < 3; ++i) {
    result[i] = parse_number(value, value.node[i], "a list of 3 numbers [x, y, z]");
    check_range(value, result[i], about, "each number must be ");
  }
  return result;
}

Quat rotation_from(const YamlValue& value) {
  constexpr const char* kType = "a list of 4 numbers [x, y, z, w]";
  if (!value.node.IsSequence() || value.node.size() != 4) {
    value.refuse(std::string("must be ") + kType);
  }
  Quat result;
  for (int i = 0; i < 4; ++i) result.coeffs()[i] = parse_number(value, value.node[i], kType);
  if (!(std::abs(result.norm() - 1) <= kWrittenUnitTolerance)) {
    value.refuse("must be a unit quaternion [x, y, z, w] (length 1 within 0.001, here " +
                 number_text(result.norm()) + ")");
  }
  // A quaternion normalised once is taken as it is, so that written scenes read back bit by bit.
  if (std::abs(result.squaredNorm() - 1) > kNormalisedWithin) result.normalize();
  return result;
}

std::filesystem::path file_from(const YamlValue& value) {
  if (!value.node.IsScalar() || value.node.Scalar().empty()) value.refuse("must name a file");
  const auto path = std::filesystem::absolute(value.source->folder / value.node.Scalar());
  const std::string why = why_not_readable(path);
  if (!why.empty()) value.refuse(why + ": " + path.lexically_normal().string());
  return path.lexically_normal();
}

std::vector<YamlValue> entries_of(const YamlValue& value) {
  if (!value.node.IsSequence()) value.refuse("must be a list");
  std::vector<YamlValue> entries;
  for (const auto& node : value.node) {
    const std::string key = value.key + "[" + std::to_string(entries.size()) + "]";
    entries.push_back({node, line_of(node, value.line), key, value.source});
  }
  return entries;
}

}  // namespace palpate::scene
