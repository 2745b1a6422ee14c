// What an object remembers, as bytes. One function of it, exchange(StateArchive&), names its
// members once: the same call puts them into an archive that writes and takes them from one that
// reads. Numbers go bit for bit, in the order of the machine's bytes (little-endian). Each call of
// an archive begins with a fingerprint of its values' types, which is compared before any is read:
// what a program with other members wrote is refused and never read as something else.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "modules/core/crc32.h"
#include "modules/core/error.h"
#include "modules/core/types.h"

namespace palpate {

class StateArchive {
 public:
  StateArchive() = default;  ///< writes
  /// Writes into memory there is, over what it holds.
  explicit StateArchive(std::vector<std::uint8_t>&& memory) : written_(std::move(memory)) {
    written_.clear();
  }
  /// Reads. @param bytes  outlive it
  explicit StateArchive(std::span<const std::uint8_t> bytes) : reads_(true), left_(bytes) {}

  bool reads() const { return reads_; }
  /// Written so far.
  const std::vector<std::uint8_t>& bytes() const { return written_; }
  std::vector<std::uint8_t> take_bytes() && { return std::move(written_); }
  std::span<const std::uint8_t> left() const { return left_; }  ///< to be read

  /// @throws InputError where what is read is of other types, ends early or cannot be of such a
  /// value
  template <class... Values>
  void operator()(Values&... values) {
    static const std::uint32_t own = fingerprint<Values...>();
    std::uint32_t fingerprint = own;
    const bool ends = reads_ && left_.size() < sizeof fingerprint;
    if (!ends) raw(&fingerprint, sizeof fingerprint);
    if (ends || fingerprint != own) throw InputError(kOtherLayout);
    (exchange(values), ...);
  }

  /// A number that is what it is, such as a count of nodes: what was written must say the same.
  void same(std::uint64_t value) {
    std::uint64_t other = value;
    raw(&other, sizeof other);
    if (other != value) throw InputError("its state is of something else");
  }

  /// Said of what a program with other members wrote.
  static constexpr const char* kOtherLayout =
      "its state is laid out otherwise than in this program: another build of it took it";

 private:
  /// Of the types by their names, of numbers with their sizes.
  template <class... Values>
  static std::uint32_t fingerprint() {
    std::string names;
    ((names += std::string(typeid(Values).name()) + ' '), ...);
    ((names += is_number<Values>() ? std::to_string(sizeof(Values)) + ' ' : ""), ...);
    return crc32({reinterpret_cast<const std::uint8_t*>(names.data()), names.size()});
  }
  template <class Value>
  static constexpr bool is_number() {
    return std::is_arithmetic_v<Value> || std::is_enum_v<Value>;
  }

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
    } else if constexpr (is_number<Value>()) {
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
