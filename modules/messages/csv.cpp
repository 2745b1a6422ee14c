#include "modules/messages/csv.h"

#include <charconv>
#include <ostream>
#include <sstream>

#include "modules/core/units.h"
#include "modules/messages/describe.h"
#include "modules/messages/key_of.h"

namespace palpate::messages {
namespace {

// Longest first: "_m_per_s" ends in "_s".
constexpr std::array<std::string_view, 15> kUnits{
    "_rad_per_s", "_m_per_s", "_n_per_m", "_n_m", "_xyzw", "_m3", "_pa", "_hz",
    "_ns",        "_n",       "_m",       "_s",   "_j",    "_kg", "_k"};

// The names of the parts, in the order of for_each_number.
template <class T>
constexpr auto part_names() {
  if constexpr (Is<T, Mat3>) {
    return std::array<std::string_view, 9>{"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
  } else if constexpr (Is<T, Quat>) {
    return std::array<std::string_view, 4>{"x", "y", "z", "w"};
  } else {
    return std::array<std::string_view, 3>{"x", "y", "z"};
  }
}

// "topic" of "inputs.topic".
std::string_view last_part(std::string_view name) { return name.substr(name.rfind('.') + 1); }

// Walks a message for the names of its columns, or for their values.
class CsvRow {
 public:
  enum class Shows { kNames, kValues };
  CsvRow(std::ostream& stream, Shows shows) : stream_(stream), shows_(shows) {}

  void header(const Header&) {}
  template <class T>
  void key(const char*, const T&) {}
  template <class T>
  void field(const char* name, const T& value, Rule rule) {
    if (rule == Rule::kDocument) return;
    if constexpr (Composed<T>) {
      std::size_t part = 0;
      for_each_number(value, [&](double number) {
        cell(name_of_part(last_part(name), part_names<T>()[part++]), number);
      });
    } else {
      cell(last_part(name), value);
    }
  }
  template <class List, class... Parts>
  void numbers(const char*, const List& list, const Bounds& bounds, const Parts&...) {
    if (bounds.count_name == nullptr) return;
    const bool flat = std::is_floating_point_v<typename List::value_type>;
    cell(bounds.count_name, std::uint64_t{list.size() / (flat ? bounds.numbers_per_entry : 1)});
  }
  template <class List>
  void list(const char*, const List& list, std::size_t, const char* count_name) {
    if (count_name != nullptr) cell(count_name, std::uint64_t{list.size()});
  }
  template <class Compute>
  void derived(const char* name, const Compute& compute) {
    cell(name, compute());
  }
  template <class Holds>
  void require(const char*, const Holds&) {}

 private:
  template <class T>
  void cell(std::string_view name, const T& value) {
    if (!first_) stream_ << ',';
    first_ = false;
    if (shows_ == Shows::kNames) {
      stream_ << name;
    } else {
      put(value);
    }
  }
  void put(double value) { write_number(stream_, value); }
  void put(const std::string& text) { stream_ << csv_text(text); }
  template <Enumeration E>
  void put(E value) {
    stream_ << word_of(value);
  }
  template <std::integral T>
  void put(T value) {
    stream_ << value;
  }

  std::ostream& stream_;
  Shows shows_;
  bool first_ = true;
};

template <class T>
void walk(std::ostream& stream, CsvRow::Shows shows, const T& described) {
  CsvRow row(stream, shows);
  describe(row, described);
}

}  // namespace

void write_number(std::ostream& stream, double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  stream.write(text.data(), end.ptr - text.data());
}

void write_seconds(std::ostream& stream, std::int64_t ns) {
  write_number(stream, static_cast<double>(ns) / kNanosecondsPerSecond);  // 1e-9 is not exact
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"') quoted += '"';
    quoted += letter;
  }
  return quoted + '"';
}

std::string name_of_part(std::string_view field, std::string_view part) {
  const auto unit = std::ranges::find_if(
      kUnits, [&](std::string_view suffix) { return field.ends_with(suffix); });
  const std::string_view suffix = unit == kUnits.end() ? std::string_view() : *unit;
  std::string name(field.substr(0, field.size() - suffix.size()));
  name.append("_").append(part);
  return suffix == "_xyzw" ? name : name.append(suffix);
}

std::string csv_columns(const AnyMessage& message) {
  std::ostringstream names;
  std::visit([&](const auto& m) { walk(names, CsvRow::Shows::kNames, m); }, message);
  return names.str();
}

void write_csv_values(std::ostream& stream, const AnyMessage& message) {
  std::visit([&](const auto& m) { walk(stream, CsvRow::Shows::kValues, m); }, message);
}

std::string csv_columns(const ModuleStatus::Input& input) {
  std::ostringstream names;
  walk(names, CsvRow::Shows::kNames, input);
  return names.str();
}

void write_csv_values(std::ostream& stream, const ModuleStatus::Input& input) {
  walk(stream, CsvRow::Shows::kValues, input);
}

std::string key_text(const AnyMessage& message) {
  KeyOf key;
  std::visit([&](const auto& m) { describe(key, m); }, message);
  return key.text;
}

const Header& header_of(const AnyMessage& message) {
  return std::visit([](const auto& m) -> const Header& { return m.header; }, message);
}

}  // namespace palpate::messages
