// What an object remembers, as bytes. One function of it, exchange(StateArchive&), names its
// members once: the same call puts them into an archive that writes and takes them from one that
// reads. Numbers go bit for bit, in the order of the machine's bytes (little-endian).
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "modules/core/error.h"
#include "modules/core/types.h"

namespace palpate {

class StateArchive {
 public:
  StateArchive() = default;  ///< writes
  /// Reads. @param bytes  outlive it
  explicit StateArchive(std::span<const std::uint8_t> bytes) : reads_(true), left_(bytes) {}

  bool reads() const { return reads_; }
  /// Written so far.
  const std::vector<std::uint8_t>& bytes() const { return written_; }
  std::span<const std::uint8_t> left() const { return left_; }  ///< to be read

  /// @throws InputError where what is read ends early or cannot be of such a value
  template <class... Values>
  void operator()(Values&... values) {
    (exchange(values), ...);
  }

  /// A number that is what it is, such as a count of nodes: what was written must say the same.
  void same(std::uint64_t value) {
    std::uint64_t other = value;
    raw(&other, sizeof other);
    if (other != value) throw InputError("its state is of something else");
  }

 private:
  template <class Value>
  void exchange(Value& value) {
    if constexpr (requires { value.exchange(*this); }) {
      value.exchange(*this);
    } else if constexpr (requires { exchange_state(*this, value); }) {
      exchange_state(*this, value);
    } else if constexpr (std::is_same_v<Value, bool>) {
      std::uint8_t byte = value ? 1 : 0;
      raw(&byte, 1);
      value = byte != 0;
    } else if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
      raw(&value, sizeof value);
    } else if constexpr (is_fixed<Value>()) {
      raw(value.data(), sizeof(typename Value::Scalar) * static_cast<std::size_t>(value.size()));
    } else if constexpr (std::is_same_v<Value, Quat>) {
      raw(value.coeffs().data(), 4 * sizeof(double));
    } else {
      of_several(value);
    }
  }

  /// A matrix whose size its type says.
  template <class Value>
  static constexpr bool is_fixed() {
    if constexpr (requires { Value::SizeAtCompileTime; }) {
      return Value::SizeAtCompileTime != Eigen::Dynamic;
    } else {
      return false;
    }
  }
  /// Lies in memory as it goes into an archive.
  template <class Value>
  static constexpr bool is_plain() {
    return (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) || is_fixed<Value>();
  }

  template <class Value>
  void of_several(std::optional<Value>& value) {
    bool has = value.has_value();
    exchange(has);
    if (reads_ && has) value.emplace();
    if (reads_ && !has) value.reset();
    if (has) exchange(*value);
  }
  template <class A, class B>
  void of_several(std::pair<A, B>& pair) {
    exchange(pair.first);
    exchange(pair.second);
  }
  template <class Value, std::size_t count>
  void of_several(std::array<Value, count>& values) {
    for (Value& value : values) exchange(value);
  }
  template <class Value, class Memory>
  void of_several(std::vector<Value, Memory>& values) {
    resize(values);
    if constexpr (is_plain<Value>()) {
      if (!values.empty()) raw(values.data(), sizeof(Value) * values.size());
    } else {
      for (Value& value : values) exchange(value);
    }
  }
  template <class Value>
  void of_several(std::deque<Value>& values) {
    resize(values);
    for (Value& value : values) exchange(value);
  }
  void of_several(std::string& text) {
    resize(text);
    raw(text.data(), text.size());
  }
  void of_several(Eigen::VectorXd& values) {
    auto count = static_cast<std::uint64_t>(values.size());
    raw(&count, sizeof count);
    if (reads_) values.resize(static_cast<Eigen::Index>(within(count, sizeof(double))));
    raw(values.data(), sizeof(double) * static_cast<std::size_t>(values.size()));
  }

  template <class Values>
  void resize(Values& values) {
    std::uint64_t count = values.size();
    raw(&count, sizeof count);
    using Value = typename Values::value_type;
    if (reads_) values.resize(within(count, is_plain<Value>() ? sizeof(Value) : 1));
  }
  std::size_t within(std::uint64_t count, std::size_t size) const {
    if (count > left_.size() / size) throw InputError("its state ends early");
    return static_cast<std::size_t>(count);
  }

  void raw(void* value, std::size_t size) {
    if (size == 0) return;
    if (!reads_) {
      const auto* bytes = static_cast<const std::uint8_t*>(value);
      written_.insert(written_.end(), bytes, bytes + size);
      return;
    }
    if (size > left_.size()) throw InputError("its state ends early");
    std::memcpy(value, left_.data(), size);
    left_ = left_.subspan(size);
  }

  bool reads_ = false;
  std::vector<std::uint8_t> written_;
  std::span<const std::uint8_t> left_;
};

inline void exchange_state(StateArchive& archive, Pose& pose) {
  archive(pose.position, pose.rotation);
}
inline void exchange_state(StateArchive& archive, Twist& twist) {
  archive(twist.linear, twist.angular);
}

}  // namespace palpate
