#include "python/topic_columns.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstring>

#include "modules/messages/describe.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

using messages::Bounds;
using messages::Composed;
using messages::Enumeration;
using messages::Rule;

template <class T>
constexpr Column::Kind kind_of() {
  if constexpr (std::is_same_v<T, bool>) return Column::Kind::kFlag;
  if constexpr (std::is_same_v<T, std::uint8_t>) return Column::Kind::kUnsigned8;
  if constexpr (std::is_same_v<T, std::uint32_t>) return Column::Kind::kUnsigned32;
  if constexpr (std::is_same_v<T, std::uint64_t>) return Column::Kind::kUnsigned64;
  if constexpr (std::is_same_v<T, std::int64_t>) return Column::Kind::kSigned64;
  if constexpr (std::is_same_v<T, float>) return Column::Kind::kFloat;
  if constexpr (Composed<T> || std::is_same_v<T, double>) return Column::Kind::kDouble;
  return Column::Kind::kText;
}

py::dtype dtype_of(Column::Kind kind) {
  switch (kind) {
    case Column::Kind::kFlag:
      return py::dtype::of<bool>();
    case Column::Kind::kUnsigned8:
      return py::dtype::of<std::uint8_t>();
    case Column::Kind::kUnsigned32:
      return py::dtype::of<std::uint32_t>();
    case Column::Kind::kUnsigned64:
      return py::dtype::of<std::uint64_t>();
    case Column::Kind::kSigned64:
      return py::dtype::of<std::int64_t>();
    case Column::Kind::kFloat:
      return py::dtype::of<float>();
    default:
      return py::dtype::of<double>();
  }
}

/// Appends a message's fields to the columns, which its first message makes.
class ColumnFiller {
 public:
  ColumnFiller(std::vector<Column>& columns, bool first) : columns_(columns), first_(first) {}

  void header(const Header& h) { messages::describe(*this, h); }
  template <class T>
  void key(const char* name, const T& value) {
    field(name, value, Rule::kPlain);
  }
  template <class T>
  void field(const char* name, const T& value, Rule) {
    Column& column = next<T>(name, shape_of<T>(), in_list_);
    if (!in_list_ || !blank_) put(column, value);
  }
  template <class T>
  void numbers(const char* name, const std::vector<T>& list, const Bounds& bounds) {
    const std::size_t width = bounds.numbers_per_entry;
    Column& column = next<T>(name, shape_of_width(width), true);
    put_bytes(column, list.data(), list.size() * sizeof(T));
    end_list(column, list.size() / width);
  }
  template <class T, std::size_t kWidth>
  void numbers(const char* name, const std::vector<std::array<T, kWidth>>& list, const Bounds&) {
    Column& column = next<T>(name, shape_of_width(kWidth), true);
    put_bytes(column, list.data(), list.size() * kWidth * sizeof(T));
    end_list(column, list.size());
  }
  template <class List, class Parts>
  void numbers(const char* name, const List& list, const Bounds& bounds, const Parts& parts) {
    using Number = std::remove_cvref_t<decltype(*parts(list.front())[0])>;
    Column& column = next<Number>(name, shape_of_width(bounds.numbers_per_entry), true);
    for (const auto& entry : list) {
      for (const Number* part : parts(entry)) put(column, *part);
    }
    end_list(column, list.size());
  }
  template <class Entry>
  void list(const char*, const std::vector<Entry>& list, std::size_t, const char*) {
    in_list_ = true;
    const std::size_t begin = at_;
    for (const Entry& entry : list) {
      at_ = begin;
      messages::describe(*this, entry);
      first_here_ = false;
    }
    if (list.empty()) {  // its columns, without an entry
      blank_ = true;
      const Entry none{};
      messages::describe(*this, none);
      blank_ = false;
    }
    first_here_ = true;
    in_list_ = false;
    for (std::size_t i = begin; i < at_; ++i) end_list(columns_[i], list.size());
  }
  template <class Compute>
  void derived(const char* name, const Compute& compute) {
    field(name, compute(), Rule::kPlain);
  }
  template <class Holds>
  void require(const char*, const Holds&) {}

 private:
  template <class T>
  static std::vector<std::size_t> shape_of() {
    if constexpr (messages::Is<T, Mat3>) return {3, 3};
    if constexpr (messages::Is<T, Quat>) return {4};
    if constexpr (messages::Is<T, Vec3>) return {3};
    return {};
  }
  static std::vector<std::size_t> shape_of_width(std::size_t width) {
    return width == 1 ? std::vector<std::size_t>{} : std::vector<std::size_t>{width};
  }

  template <class T>
  Column& next(const char* name, std::vector<std::size_t> shape, bool listed) {
    if (first_ && first_here_) {
      columns_.push_back({name, kind_of<T>(), std::move(shape), listed, {}, {}, {}});
      if (listed) columns_.back().offsets.push_back(0);
    }
    return columns_[at_++];
  }
  static void end_list(Column& column, std::size_t entries) {
    column.offsets.push_back(column.offsets.back() + static_cast<std::int64_t>(entries));
  }
  static void put_bytes(Column& column, const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    column.bytes.insert(column.bytes.end(), bytes, bytes + size);
  }
  template <class T>
  static void put(Column& column, const T& value) {
    if constexpr (Composed<T>) {
      messages::for_each_number(value, [&](double number) { put(column, number); });
    } else if constexpr (Enumeration<T>) {
      column.texts.emplace_back(messages::word_of(value));
    } else if constexpr (std::is_arithmetic_v<T>) {
      put_bytes(column, &value, sizeof value);
    } else {
      column.texts.push_back(value);
    }
  }

  std::vector<Column>& columns_;
  bool first_, first_here_ = true;
  bool in_list_ = false, blank_ = false;
  std::size_t at_ = 0;
};

/// What is no UTF-8 was said by a stranger: U+FFFD stands for it.
py::list list_of(const std::vector<std::string>& texts) {
  py::list list;
  for (const std::string& text : texts) {
    PyObject* const decoded =
        PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace");
    if (decoded == nullptr) throw py::error_already_set();
    list.append(py::reinterpret_steal<py::str>(decoded));
  }
  return list;
}

/// An array over the column's own memory.
py::object array_of(Column& column) {
  if (column.kind == Column::Kind::kText) return list_of(column.texts);
  const py::dtype dtype = dtype_of(column.kind);
  std::size_t numbers = 1;
  for (const std::size_t n : column.shape) numbers *= n;
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(
      column.bytes.size() / (numbers * static_cast<std::size_t>(dtype.itemsize())))};
  for (const std::size_t n : column.shape) shape.push_back(static_cast<py::ssize_t>(n));
  auto* kept = new std::vector<std::uint8_t>(std::move(column.bytes));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<std::uint8_t>*>(p); });
  return py::array(dtype, shape, {}, kept->data(), owner);
}

}  // namespace

void TopicColumns::add(const messages::AnyMessage& message) {
  ColumnFiller filler(columns_, size_ == 0);
  std::visit([&](const auto& m) { messages::describe(filler, m); }, message);
  ++size_;
}

py::list TopicColumns::take() {
  py::list result;
  for (Column& column : columns_) {
    py::object values = array_of(column);
    if (column.listed) {
      values = py::make_tuple(values, py::array(py::dtype::of<std::int64_t>(),
                                                {column.offsets.size()}, column.offsets.data()));
    }
    result.append(py::make_tuple(column.name, values));
  }
  columns_.clear();
  return result;
}

}  // namespace palpate::python
