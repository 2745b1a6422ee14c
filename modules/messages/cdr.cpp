#include "modules/messages/cdr.h"

#include <bit>
#include <cstring>

#include "modules/messages/describe.h"
#include "modules/messages/message_checks.h"

namespace palpate::messages {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie");

constexpr std::array<std::uint8_t, kEncapsulationBytes> kLittleEndian{0, 1, 0, 0};
constexpr std::size_t kMaxPadding = 3;  // of a payload to whole words

// Lists that lie in memory as they travel, as their numbers.
template <class T>
auto flat(std::vector<T>& list) {
  return std::span(list);
}
template <class T>
auto flat(const std::vector<T>& list) {
  return std::span(list);
}
template <class T, std::size_t kWidth>
auto flat(std::vector<std::array<T, kWidth>>& list) {
  return std::span<T>(list.empty() ? nullptr : list.front().data(), kWidth * list.size());
}
template <class T, std::size_t kWidth>
auto flat(const std::vector<std::array<T, kWidth>>& list) {
  return std::span<const T>(list.empty() ? nullptr : list.front().data(), kWidth * list.size());
}

// Walked twice: without memory it measures, with it it writes.
class CdrWriter {
 public:
  explicit CdrWriter(std::uint8_t* out = nullptr) : out_(out) {}
  std::size_t size() const { return at_; }

  void header(const Header& h) { describe(*this, h); }
  template <class T>
  void key(const char* name, const T& value) {
    field(name, value, Rule::kPlain);
  }
  template <class T>
  void field(const char*, const T& value, Rule) {
    put(value);
  }
  template <class List>
  void numbers(const char*, const List& list, const Bounds&) {
    const auto values = flat(list);
    put(static_cast<std::uint32_t>(values.size()));
    if (!values.empty()) align(sizeof(values[0]));
    bytes(values.data(), values.size_bytes());
  }
  template <class List, class Parts>
  void numbers(const char*, const List& list, const Bounds& bounds, const Parts& parts) {
    using Number = std::remove_cvref_t<decltype(*parts(list.front())[0])>;
    put(static_cast<std::uint32_t>(list.size() * bounds.numbers_per_entry));
    if (out_ == nullptr) {
      at_ += list.size() * bounds.numbers_per_entry * sizeof(Number);
      return;
    }
    for (const auto& entry : list) {
      for (const Number* part : parts(entry)) bytes(part, sizeof(Number));
    }
  }
  template <class List>
  void list(const char*, const List& list, std::size_t, const char*) {
    put(static_cast<std::uint32_t>(list.size()));
    for (const auto& entry : list) describe(*this, entry);
  }
  template <class Compute>
  void derived(const char*, const Compute&) {}
  template <class Holds>
  void require(const char*, const Holds&) {}

 private:
  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) {
    align(sizeof(T));
    bytes(&value, sizeof value);
  }
  template <Enumeration E>
  void put(E value) {
    put(static_cast<std::uint32_t>(value));
  }
  template <Composed T>
  void put(const T& value) {
    for_each_number(value, [this](double number) { put(number); });
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    bytes(text.c_str(), text.size() + 1);
  }
  void align(std::size_t size) {
    const std::size_t padding = (0 - at_) % size;
    if (out_ != nullptr) std::memset(out_ + at_, 0, padding);
    at_ += padding;
  }
  void bytes(const void* from, std::size_t count) {
    if (out_ != nullptr && count > 0) std::memcpy(out_ + at_, from, count);
    at_ += count;
  }

  std::uint8_t* out_;
  std::size_t at_ = 0;  // alignment counts from here, after the encapsulation
};

template <bool kSwap, class T>
T number_at(const std::uint8_t* from) {
  std::array<std::uint8_t, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if constexpr (kSwap) std::ranges::reverse(bytes);
  return std::bit_cast<T>(bytes);
}

// Reads as long as nothing failed; what follows a failure stays as it is.
template <bool kSwap>
class CdrReader {
 public:
  explicit CdrReader(Payload bytes) : bytes_(bytes) {}

  const char* finish() {
    if (failed_ == nullptr && bytes_.size() - at_ > kMaxPadding) failed_ = "payload";
    return failed_;
  }

  void header(Header& h) { describe(*this, h); }
  template <class T>
  void key(const char* name, T& value) {
    field(name, value, Rule::kName);
  }
  template <class T>
  void field(const char* name, T& value, Rule rule) {
    get(name, value, rule);
  }
  template <class List>
  void numbers(const char* name, List& list, const Bounds& bounds) {
    using Number = typename decltype(flat(list))::value_type;
    constexpr std::size_t kInEntry = sizeof(typename List::value_type) / sizeof(Number);
    const std::size_t count = length(name, sizeof(Number), bounds);
    if (failed_ != nullptr) return;
    list.resize(count / kInEntry);
    const auto values = flat(list);
    if (count > 0) std::memcpy(values.data(), bytes_.data() + at_, values.size_bytes());
    if constexpr (kSwap && sizeof(Number) > 1) {
      for (std::size_t i = 0; i < count; ++i) {
        values[i] = number_at<kSwap, Number>(bytes_.data() + at_ + i * sizeof(Number));
      }
    }
    at_ += values.size_bytes();
  }
  template <class List, class Parts>
  void numbers(const char* name, List& list, const Bounds& bounds, const Parts& parts) {
    using Number = std::remove_cvref_t<decltype(*parts(list.front())[0])>;
    const std::size_t count = length(name, sizeof(Number), bounds);
    if (failed_ != nullptr) return;
    list.resize(count / bounds.numbers_per_entry);
    for (auto& entry : list) {
      for (Number* part : parts(entry)) {
        *part = number_at<kSwap, Number>(bytes_.data() + at_);
        at_ += sizeof(Number);
      }
    }
  }
  template <class List>
  void list(const char* name, List& list, std::size_t max, const char*) {
    // Every entry takes a byte or more: a long list of nothing is not believed.
    const std::size_t count = length(name, 1, Bounds{1, 0, max});
    if (failed_ != nullptr) return;
    list.resize(count);
    for (auto& entry : list) {
      if (failed_ != nullptr) return;
      describe(*this, entry);
    }
  }
  template <class Compute>
  void derived(const char*, const Compute&) {}
  template <class Holds>
  void require(const char*, const Holds&) {}

 private:
  void fail(const char* field) {
    if (failed_ == nullptr) failed_ = field;
  }
  std::size_t left() const { return bytes_.size() - at_; }

  template <class T>
  requires(std::is_arithmetic_v<T> && !std::same_as<T, bool>) void get(const char*, T& value,
                                                                       Rule) {
    const std::size_t padding = (0 - at_) % sizeof(T);
    if (failed_ != nullptr || left() < padding + sizeof(T)) return fail("payload");
    at_ += padding;
    value = number_at<kSwap, T>(bytes_.data() + at_);
    at_ += sizeof(T);
  }
  void get(const char* name, bool& value, Rule rule) {
    std::uint8_t byte = 0;
    get(name, byte, rule);
    if (byte > 1) return fail(name);
    value = byte == 1;
  }
  template <Enumeration E>
  void get(const char* name, E& value, Rule rule) {
    std::uint32_t number = 0;
    get(name, number, rule);
    if (number >= Words<E>::texts.size()) return fail(name);  // before it is narrowed to a byte
    value = static_cast<E>(number);
  }
  template <Composed T>
  void get(const char* name, T& value, Rule rule) {
    for_each_number(value, [&](double& number) { get(name, number, rule); });
  }
  void get(const char* name, std::string& text, Rule rule) {
    std::uint32_t size = 0;
    get(name, size, rule);
    if (failed_ != nullptr || size > left()) return fail("payload");
    // Counted with the zero byte at its end; nothing at all is an empty text too.
    if (size > kMaxTextBytes + 1) return fail(name);
    if (size > 0 && bytes_[at_ + size - 1] != 0) return fail(name);
    // By a pointer to bytes: they are the characters.
    text.assign(reinterpret_cast<const char*>(bytes_.data() + at_), size > 0 ? size - 1 : 0);
    at_ += size;
  }
  // How many numbers of that size follow.
  std::size_t length(const char* name, std::size_t bytes_each, const Bounds& bounds) {
    std::uint32_t count = 0;
    get(name, count, Rule::kPlain);
    if (failed_ != nullptr) return 0;
    if (count > 0) at_ += std::min(left(), (0 - at_) % bytes_each);
    const std::size_t entries = count / bounds.numbers_per_entry;
    if (count > left() / bytes_each) {
      fail("payload");
    } else if (count % bounds.numbers_per_entry != 0 || entries < bounds.min_entries ||
               entries > bounds.max_entries) {
      fail(name);
    }
    return count;
  }

  Payload bytes_;
  std::size_t at_ = 0;
  const char* failed_ = nullptr;
};

template <bool kSwap, class Message>
const char* read(Payload bytes, Message& message) {
  CdrReader<kSwap> reader(bytes);
  describe(reader, message);
  return reader.finish();
}

}  // namespace

template <class Message>
void write_payload(const Message& message, std::vector<std::uint8_t>& payload) {
  CdrWriter measure;
  describe(measure, message);
  payload.resize(kEncapsulationBytes + measure.size());
  std::ranges::copy(kLittleEndian, payload.begin());
  CdrWriter writer(payload.data() + kEncapsulationBytes);
  describe(writer, message);
}

template <class Message>
const char* read_payload(Payload payload, Message& message) {
  if (payload.size() < kEncapsulationBytes || payload[0] != 0) return "payload";
  const Payload bytes = payload.subspan(kEncapsulationBytes);
  if (payload[1] == 1) return read<false>(bytes, message);
  if (payload[1] == 0) return read<true>(bytes, message);
  return "payload";
}

template <class Message>
const char* encode(const Message& message, std::vector<std::uint8_t>& payload) {
  if (const char* field = first_invalid_field(message)) return field;
  write_payload(message, payload);
  return nullptr;
}

template <class Message>
const char* decode(Payload payload, Message& message) {
  if (const char* field = read_payload(payload, message)) return field;
  return first_invalid_field(message);
}

#define PALPATE_INSTANTIATE(Message)                                       \
  template void write_payload(const Message&, std::vector<std::uint8_t>&); \
  template const char* read_payload(Payload, Message&);                    \
  template const char* encode(const Message&, std::vector<std::uint8_t>&); \
  template const char* decode(Payload, Message&);
PALPATE_MESSAGES(PALPATE_INSTANTIATE)
#undef PALPATE_INSTANTIATE

}  // namespace palpate::messages
