#include "python/message_arrays.h"

#include "modules/messages/describe.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

using messages::Bounds;
using messages::Composed;
using messages::Enumeration;
using messages::Rule;
using Shape = std::vector<py::ssize_t>;

/// Numbers of one kind in memory that `owner` keeps.
template <class T>
py::array view(const T* data, const Shape& shape, const Shape& strides, const py::handle& owner) {
  py::array array(py::dtype::of<T>(), shape, strides, data, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// Vectors, rotations and matrices: their shape and strides [bytes]; matrices lie column by column.
template <Composed T>
void add_axes(Shape& shape, Shape& strides) {
  const py::ssize_t number = sizeof(double);
  if constexpr (messages::Is<T, Mat3>) {
    shape.insert(shape.end(), {3, 3});
    strides.insert(strides.end(), {number, 3 * number});
  } else {
    shape.push_back(messages::Is<T, Quat> ? 4 : 3);
    strides.push_back(number);
  }
}
const double* first_number(const Vec3& v) { return v.data(); }
const double* first_number(const Mat3& m) { return m.data(); }
const double* first_number(const Quat& q) { return q.coeffs().data(); }

template <class T>
py::object scalar(const T& value) {
  if constexpr (Enumeration<T>) {
    return py::str(messages::word_of(value));
  } else {
    return py::cast(value);
  }
}

/// Fields of the entries of a list, each as a strided view over all entries.
class EntryViews {
 public:
  EntryViews(py::dict& out, std::size_t count, std::size_t stride, const py::handle& owner)
      : out_(out),
        count_(static_cast<py::ssize_t>(count)),
        stride_(static_cast<py::ssize_t>(stride)),
        owner_(owner) {}

  template <class T>
  void field(const char* name, const T& first, Rule) {
    Shape shape{count_}, strides{stride_};
    if constexpr (Composed<T>) {
      add_axes<T>(shape, strides);
      out_[name] = view(first_number(first), shape, strides, owner_);
    } else if constexpr (std::is_arithmetic_v<T>) {
      out_[name] = view(&first, shape, strides, owner_);
    } else {
      py::list texts;
      for (py::ssize_t i = 0; i < count_; ++i) {
        const auto* bytes = reinterpret_cast<const char*>(&first) + i * stride_;
        texts.append(scalar(*reinterpret_cast<const T*>(bytes)));
      }
      out_[name] = std::move(texts);
    }
  }

 private:
  py::dict& out_;
  py::ssize_t count_, stride_;
  const py::handle& owner_;
};

class MessageViews {
 public:
  MessageViews(py::dict& out, py::handle owner) : out_(out), owner_(owner) {}

  void header(const Header& h) { messages::describe(*this, h); }
  template <class T>
  void key(const char* name, const T& value) {
    out_[name] = scalar(value);
  }
  template <class T>
  void field(const char* name, const T& value, Rule) {
    if constexpr (Composed<T>) {
      Shape shape, strides;
      add_axes<T>(shape, strides);
      out_[name] = view(first_number(value), shape, strides, owner_);
    } else {
      out_[name] = scalar(value);
    }
  }
  template <class T>
  void numbers(const char* name, const std::vector<T>& list, const Bounds& bounds) {
    const auto width = static_cast<py::ssize_t>(bounds.numbers_per_entry);
    const auto count = static_cast<py::ssize_t>(list.size()) / width;
    const py::ssize_t size = sizeof(T);
    static const T kNone{};
    const T* data = list.empty() ? &kNone : list.data();
    out_[name] = width == 1 ? view(data, {count}, {size}, owner_)
                            : view(data, {count, width}, {width * size, size}, owner_);
  }
  template <class T, std::size_t kWidth>
  void numbers(const char* name, const std::vector<std::array<T, kWidth>>& list, const Bounds&) {
    const py::ssize_t size = sizeof(T), width = kWidth;
    static const T kNone{};
    const T* data = list.empty() ? &kNone : list.front().data();
    out_[name] =
        view(data, {static_cast<py::ssize_t>(list.size()), width}, {width * size, size}, owner_);
  }
  template <class List, class Parts>
  void numbers(const char* name, const List& list, const Bounds& bounds, const Parts& parts) {
    using Entry = typename List::value_type;
    static const Entry kNone{};
    const auto first = parts(list.empty() ? kNone : list.front());
    using Number = std::remove_cvref_t<decltype(*first[0])>;
    const auto count = static_cast<py::ssize_t>(list.size());
    const auto width = static_cast<py::ssize_t>(bounds.numbers_per_entry);
    if constexpr (Enumeration<Number>) {
      py::list words;
      for (const Entry& entry : list) words.append(scalar(*parts(entry)[0]));
      out_[name] = std::move(words);
    } else {
      const auto apart = width == 1 ? py::ssize_t{sizeof(Number)}
                                    : reinterpret_cast<const char*>(first[1]) -
                                          reinterpret_cast<const char*>(first[0]);
      out_[name] = view(first[0], {count, width}, {sizeof(Entry), apart}, owner_);
    }
  }
  template <class Entry>
  void list(const char*, const std::vector<Entry>& list, std::size_t, const char*) {
    static const Entry kNone{};
    EntryViews views(out_, list.size(), sizeof(Entry), owner_);
    messages::describe(views, list.empty() ? kNone : list.front());
  }
  template <class Compute>
  void derived(const char* name, const Compute& compute) {
    out_[name] = py::cast(compute());
  }
  template <class Holds>
  void require(const char*, const Holds&) {}

 private:
  py::dict& out_;
  py::handle owner_;
};

/// An object of Python's that keeps `kept` as long as it lives.
template <class Kept>
py::capsule keeper(Kept kept) {
  return py::capsule(new Kept(std::move(kept)), [](void* p) { delete static_cast<Kept*>(p); });
}

}  // namespace

template <class Message>
py::dict arrays_of(std::shared_ptr<const Message> message) {
  const Message& read = *message;
  const py::capsule owner = keeper(std::move(message));
  py::dict out;
  MessageViews views(out, owner);
  messages::describe(views, read);
  return out;
}
#define PALPATE_INSTANTIATE(Message) \
  template py::dict arrays_of<Message>(std::shared_ptr<const Message>);
PALPATE_MESSAGES(PALPATE_INSTANTIATE)
#undef PALPATE_INSTANTIATE

py::dict arrays_of_any(std::shared_ptr<const messages::AnyMessage> message) {
  return std::visit(
      [&](const auto& held) {
        using Message = std::remove_cvref_t<decltype(held)>;
        return arrays_of(std::shared_ptr<const Message>(message, &held));
      },
      *message);
}

}  // namespace palpate::python
