#include "modules/geometry/ply_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "modules/core/error.h"
#include "modules/geometry/mesh_text.h"
#include "modules/geometry/polygon_fan.h"

namespace palpate::geometry {
namespace {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct TypeName {
  std::string_view word, other;  ///< of 1994, and of later writers
  std::size_t bytes;
};
constexpr std::array<TypeName, 8> kTypes{{{"char", "int8", 1},
                                          {"uchar", "uint8", 1},
                                          {"short", "int16", 2},
                                          {"ushort", "uint16", 2},
                                          {"int", "int32", 4},
                                          {"uint", "uint32", 4},
                                          {"float", "float32", 4},
                                          {"double", "float64", 8}}};

std::optional<Type> type_named(std::string_view word) {
  const auto found = std::ranges::find_if(
      kTypes, [&](const TypeName& type) { return type.word == word || type.other == word; });
  if (found == kTypes.end()) return std::nullopt;
  return static_cast<Type>(found - kTypes.begin());
}

struct Property {
  std::string name;
  Type type = Type::kFloat;
  std::optional<Type> count;  ///< of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

enum class Format { kText, kLittleEndian, kBigEndian };

struct PlyHeader {
  Format format = Format::kText;
  std::vector<Element> elements;
  std::size_t bytes = 0;
};

/// Of any number, as a person would write a whole one.
std::string text_of(double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.15g", number);
  return text.data();
}

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::filesystem::path& file)
      : bytes_(bytes), file_(file) {}

  PlyHeader read() {
    if (next_line() != "ply") refuse("must be 'ply'");
    while (true) {
      const std::string_view line = next_line();
      const auto words = mesh_words(line);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words.size() == 1 && words[0] == "end_header") break;
      take(words, line);
    }
    if (!has_format_) refuse("comes before any 'format'");
    header_.bytes = at_;
    return std::move(header_);
  }

 private:
  void take(const std::vector<std::string_view>& words, std::string_view line) {
    const std::string said = "'" + std::string(line.substr(0, 60)) + "' ";
    if (words[0] == "format" && words.size() == 3) {
      take_format(words[1], said);
    } else if (words[0] == "element" && words.size() == 3) {
      Element element{std::string(words[1]), 0, {}};
      if (!is_mesh_number(words[2], element.count)) refuse(said + "must end in a number");
      header_.elements.push_back(std::move(element));
    } else if (words[0] == "property" && !header_.elements.empty()) {
      header_.elements.back().properties.push_back(property(words, said));
    } else {
      refuse(said + "is no line of a PLY header");
    }
  }

  void take_format(std::string_view word, const std::string& said) {
    constexpr std::array<std::string_view, 3> kFormats{"ascii", "binary_little_endian",
                                                       "binary_big_endian"};
    const auto* found = std::ranges::find(kFormats, word);
    if (found == kFormats.end()) {
      refuse(said + "must name ascii, binary_little_endian or binary_big_endian");
    }
    header_.format = static_cast<Format>(found - kFormats.begin());
    has_format_ = true;
  }

  Property property(const std::vector<std::string_view>& words, const std::string& said) const {
    const bool list = words.size() == 5 && words[1] == "list";
    const auto type = words.size() < 3 ? std::nullopt : type_named(words[list ? 3 : 1]);
    Property result{std::string(words.back()), type.value_or(Type::kFloat), {}};
    if (list) result.count = type_named(words[2]);
    const bool counted = !list || (result.count && *result.count < Type::kFloat);
    if ((!list && words.size() != 3) || !type || !counted) {
      refuse(said + "must be 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    }
    return result;
  }

  std::string_view next_line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) {
      throw InputError(file_.string() + ": its header has no end ('end_header')");
    }
    std::string_view line = bytes_.substr(at_, end - at_);
    if (line.ends_with('\r')) line.remove_suffix(1);
    at_ = end + 1;
    ++line_;
    return line;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(file_.string() + ":" + std::to_string(line_) + ": " + what);
  }

  std::string_view bytes_;
  const std::filesystem::path& file_;
  std::size_t at_ = 0;
  int line_ = 0;
  bool has_format_ = false;
  PlyHeader header_;
};

class Body {
 public:
  Body(std::string_view bytes, Format format, const std::filesystem::path& file)
      : bytes_(bytes), format_(format), file_(file) {}

  /// Of the element that is read, for errors.
  void begin(const Element& element, std::size_t index) {
    element_ = &element;
    index_ = index;
  }

  double number(Type type) {
    if (format_ == Format::kText) return from_text(type);
    switch (type) {
      case Type::kInt8:
        return raw<std::int8_t>();
      case Type::kUint8:
        return raw<std::uint8_t>();
      case Type::kInt16:
        return raw<std::int16_t>();
      case Type::kUint16:
        return raw<std::uint16_t>();
      case Type::kInt32:
        return raw<std::int32_t>();
      case Type::kUint32:
        return raw<std::uint32_t>();
      case Type::kFloat:
        return static_cast<double>(raw<float>());
      case Type::kDouble:
        return raw<double>();
    }
    return 0;
  }

  /// Of a list. Each entry takes a byte at least: a longer one is not there.
  std::size_t count(Type type) {
    const double said = number(type);
    if (!(said >= 0) || said > static_cast<double>(bytes_.size())) {
      refuse("has a list of " + text_of(said) + " entries");
    }
    return static_cast<std::size_t>(said);
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(file_.string() + ": " + element_->name + " " + std::to_string(index_) +
                     " of " + std::to_string(element_->count) + " " + what);
  }

 private:
  template <class Number>
  Number raw() {
    std::array<char, sizeof(Number)> part{};
    if (bytes_.size() < part.size()) refuse("is not there: the file ends before");
    std::copy_n(bytes_.begin(), part.size(), part.begin());
    bytes_.remove_prefix(part.size());
    const bool little = std::endian::native == std::endian::little;
    if (little != (format_ == Format::kLittleEndian)) std::ranges::reverse(part);
    return std::bit_cast<Number>(part);
  }

  double from_text(Type type) {
    constexpr std::string_view kSpace = " \t\r\n";
    bytes_.remove_prefix(std::min(bytes_.find_first_not_of(kSpace), bytes_.size()));
    const std::string_view word = bytes_.substr(0, bytes_.find_first_of(kSpace));
    if (word.empty()) refuse("is not there: the file ends before");
    double number = 0;
    if (!is_mesh_number(word, number)) {
      refuse("holds '" + std::string(word.substr(0, 40)) + "', which is no number");
    }
    bytes_.remove_prefix(word.size());
    return type == Type::kFloat ? static_cast<double>(static_cast<float>(number)) : number;
  }

  std::string_view bytes_;
  Format format_;
  const std::filesystem::path& file_;
  const Element* element_ = nullptr;
  std::size_t index_ = 0;
};

bool is_corners(const Property& property) {
  return property.count && (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// One vertex, face or whatever it is.
void read_entry(const Element& element, Body& body, Vec3& place, std::vector<double>& corners) {
  constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
  for (const Property& property : element.properties) {
    if (property.count) {
      const std::size_t count = body.count(*property.count);
      const bool wanted = is_corners(property);
      for (std::size_t i = 0; i < count; ++i) {
        const double number = body.number(property.type);
        if (wanted) corners.push_back(number);
      }
      continue;
    }
    const double number = body.number(property.type);
    const auto* axis = std::ranges::find(kAxes, property.name);
    if (axis != kAxes.end()) place[axis - kAxes.begin()] = number;
  }
}

void add_face(const std::vector<double>& corners, const Body& body, TriangleSurface& surface) {
  const std::size_t nodes = surface.nodes.size();
  std::vector<std::uint32_t> named;
  for (const double corner : corners) {
    if (!(corner >= 0 && corner < static_cast<double>(nodes))) {
      body.refuse("names vertex " + text_of(corner) + "; allowed: 0 to " +
                  std::to_string(static_cast<long long>(nodes) - 1));
    }
    named.push_back(static_cast<std::uint32_t>(corner));
  }
  add_fan(named, surface);
}

bool has(const Element& element, std::string_view name) {
  return std::ranges::any_of(element.properties, [&](const Property& property) {
    return property.name == name && !property.count;
  });
}

/// What has to be there, and in this order: a face is judged by the vertices before it.
void check_elements(const PlyHeader& header, const std::filesystem::path& file) {
  bool vertices = false, faces = false;
  for (const Element& element : header.elements) {
    vertices |=
        element.name == "vertex" && has(element, "x") && has(element, "y") && has(element, "z");
    faces |=
        vertices && element.name == "face" && std::ranges::any_of(element.properties, is_corners);
  }
  if (faces) return;
  throw InputError(
      file.string() +
      ": must hold an element 'vertex' with x, y and z, and behind it 'face' with a list "
      "vertex_indices");
}

}  // namespace

TriangleSurface parse_ply(std::string_view bytes, const std::filesystem::path& file) {
  const PlyHeader header = HeaderReader(bytes, file).read();
  check_elements(header, file);
  Body body(bytes.substr(header.bytes), header.format, file);
  TriangleSurface surface;
  std::vector<double> corners;
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;
    for (std::size_t i = 0; i < element.count; ++i) {
      Vec3 place = Vec3::Zero();
      corners.clear();
      body.begin(element, i);
      read_entry(element, body, place, corners);
      if (element.name == "vertex") surface.nodes.push_back(place);
      if (element.name == "face") add_face(corners, body, surface);
    }
  }
  return surface;
}

}  // namespace palpate::geometry
