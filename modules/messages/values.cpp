#include "modules/messages/values.h"

#include <bit>
#include <sstream>

#include "modules/messages/csv.h"
#include "modules/messages/describe.h"
#include "modules/messages/idle_visitor.h"

namespace palpate::messages {
namespace {

class Lister {
 public:
  explicit Lister(std::vector<Value>& values) : values_(values) {}

  void header(const Header& h) { describe(*this, h); }
  template <class T>
  void key(const char* name, const T& value) {
    field(name, value, Rule::kPlain);
  }
  template <class T>
  void field(const char* name, const T& value, Rule) {
    if constexpr (Composed<T>) {
      std::size_t index = 0;
      for_each_number(value, [&](double number) { add(name, index++, number); });
    } else {
      add(name, Value::kNone, value);
    }
  }
  template <class T>
  void numbers(const char* name, const std::vector<T>& list, const Bounds&) {
    count(name, list.size());
    for (std::size_t i = 0; i < list.size(); ++i) add(name, i, list[i]);
  }
  template <class T, std::size_t kWidth>
  void numbers(const char* name, const std::vector<std::array<T, kWidth>>& list, const Bounds&) {
    count(name, list.size());
    std::size_t index = 0;
    for (const auto& entry : list) {
      for (const T number : entry) add(name, index++, number);
    }
  }
  template <class List, class Parts>
  void numbers(const char* name, const List& list, const Bounds&, const Parts& parts) {
    count(name, list.size());
    std::size_t index = 0;
    for (const auto& entry : list) {
      for (const auto* part : parts(entry)) add(name, index++, *part);
    }
  }
  template <class List>
  void list(const char* name, const List& list, std::size_t, const char*) {
    count(name, list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      entry_ = i;
      describe(*this, list[i]);
    }
    entry_ = Value::kNone;
  }
  template <class Compute>
  void derived(const char*, const Compute&) {}
  template <class Holds>
  void require(const char*, const Holds&) {}

 private:
  Value& next(const char* name, std::size_t index) {
    values_.push_back({});
    values_.back().field = name;
    values_.back().entry = entry_;
    values_.back().index = index;
    return values_.back();
  }
  template <std::floating_point T>
  void add(const char* name, std::size_t index, T number) {
    next(name, index).real = number;
  }
  template <std::integral T>
  void add(const char* name, std::size_t index, T number) {
    Value& value = next(name, index);
    const bool negative = std::is_signed_v<T> && number < T{0};
    value.kind = negative ? Value::Kind::kNegative : Value::Kind::kWhole;
    value.whole =
        negative ? 0 - static_cast<std::uint64_t>(number) : static_cast<std::uint64_t>(number);
    value.real = static_cast<double>(number);
  }
  template <Enumeration E>
  void add(const char* name, std::size_t index, E word) {
    add_text(name, index, word_of(word));
  }
  void add(const char* name, std::size_t index, const std::string& text) {
    add_text(name, index, text);
  }
  void add_text(const char* name, std::size_t index, std::string_view text) {
    Value& value = next(name, index);
    value.kind = Value::Kind::kText;
    value.text = text;
  }
  void count(const char* name, std::size_t entries) {
    add(name, Value::kNone, std::uint64_t{entries});
  }

  std::vector<Value>& values_;
  std::size_t entry_ = Value::kNone;
};

/// A visitor of describe() that leaves one entry in each list that is described itself.
struct OneEntry : IdleVisitor {
  template <class List>
  void list(const char*, List& list, std::size_t, const char*) {
    list.resize(1);
  }
};

}  // namespace

bool Value::same_as(const Value& other) const {
  if (field != other.field || entry != other.entry || index != other.index) return false;
  if (kind != other.kind) return false;
  if (kind == Kind::kText) return text == other.text;
  if (kind != Kind::kReal) return whole == other.whole;
  return real == other.real ||
         std::bit_cast<std::uint64_t>(real) == std::bit_cast<std::uint64_t>(other.real);
}

void list_values(const AnyMessage& message, std::vector<Value>& values) {
  values.clear();
  Lister lister(values);
  std::visit([&](const auto& m) { describe(lister, m); }, message);
}

std::set<std::string_view> field_names() {
  std::set<std::string_view> names;
  std::vector<Value> values;
  for (AnyMessage message : one_of_each()) {
    OneEntry one_entry;
    std::visit([&](auto& m) { describe(one_entry, m); }, message);
    list_values(message, values);
    for (const Value& value : values) names.insert(value.field);
  }
  return names;
}

std::string text_of(const Value& value) {
  if (value.kind == Value::Kind::kText) return std::string(value.text);
  if (value.kind == Value::Kind::kWhole) return std::to_string(value.whole);
  if (value.kind == Value::Kind::kNegative) return "-" + std::to_string(value.whole);
  std::ostringstream text;
  write_number(text, value.real);
  return text.str();
}

std::string place_of(const Value& value) {
  const auto in_brackets = [](std::size_t number) {
    return number == Value::kNone ? std::string() : "[" + std::to_string(number) + "]";
  };
  std::string place(value.field);
  const std::size_t dot = place.find('.');
  if (dot != std::string::npos) place.insert(dot, in_brackets(value.entry));
  return place + in_brackets(value.index);
}

}  // namespace palpate::messages
