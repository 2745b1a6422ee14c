// Messages with random content, made by walking their description: valid ones, and ones with one
// field corrupted.
#pragma once

#include <cmath>
#include <limits>
#include <random>

#include "modules/messages/cdr.h"
#include "modules/messages/describe.h"
#include "modules/messages/message_checks.h"

namespace palpate::messages::testing {

using Random = std::mt19937_64;

inline double real(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
inline std::uint64_t whole(Random& random, std::uint64_t low, std::uint64_t high) {
  return std::uniform_int_distribution<std::uint64_t>(low, high)(random);
}

/// Fills a message; rules across fields are left to random_message.
class RandomFiller {
 public:
  explicit RandomFiller(Random& random) : random_(random) {}

  void header(Header& h) {
    describe(*this, h);
    h.session_token = 0;  // buses write it and take it off
  }
  template <class T>
  void key(const char* name, T& value) {
    field(name, value, Rule::kName);
  }
  template <class T>
  void field(const char*, T& value, Rule rule) {
    fill(value, rule);
  }
  template <class List>
  void numbers(const char*, List& list, const Bounds& bounds) {
    using Entry = typename List::value_type;
    list.resize(length(bounds) * (std::is_arithmetic_v<Entry> ? bounds.numbers_per_entry : 1));
    for (Entry& entry : list) fill_entry(entry);
  }
  template <class List, class Parts>
  void numbers(const char*, List& list, const Bounds& bounds, const Parts& parts) {
    list.resize(length(bounds));
    for (auto& entry : list) {
      for (auto* part : parts(entry)) fill(*part, Rule::kPlain);
    }
  }
  template <class List>
  void list(const char*, List& list, std::size_t max, const char*) {
    list.resize(length({1, 0, max}));
    for (auto& entry : list) describe(*this, entry);
  }
  template <class Compute>
  void derived(const char*, const Compute&) {}
  template <class Holds>
  void require(const char*, const Holds&) {}

 private:
  std::size_t length(const Bounds& bounds) {
    constexpr std::size_t kLongest = 40;
    return whole(random_, bounds.min_entries,
                 std::min(bounds.max_entries, std::max(bounds.min_entries, kLongest)));
  }
  void fill_entry(float& x) { x = static_cast<float>(real(random_, -1, 1)); }
  void fill_entry(double& x) { x = real(random_, -1, 1); }
  void fill_entry(std::uint32_t& x) { fill(x, Rule::kPlain); }
  void fill_entry(std::array<std::uint32_t, 3>& entry) {
    for (std::uint32_t& x : entry) fill(x, Rule::kPlain);
  }
  void fill(std::uint64_t& x, Rule rule) {
    x = whole(random_, rule == Rule::kFromOne, rule == Rule::kToken ? ~0ull : kMaxCount);
  }
  void fill(std::int64_t& x, Rule rule) {
    const bool positive = rule == Rule::kAtLeastZero || rule == Rule::kSinceSetUp;
    const auto most = static_cast<std::uint64_t>(kMaxTimeNs);
    x = static_cast<std::int64_t>(whole(random_, 0, positive ? most : 2 * most)) -
        (positive ? 0 : kMaxTimeNs);
  }
  void fill(std::uint32_t& x, Rule rule) {
    x = static_cast<std::uint32_t>(rule == Rule::kForceLimits ? whole(random_, 0, kAllForceLimits)
                                                              : random_());
  }
  void fill(bool& x, Rule) { x = whole(random_, 0, 1) == 1; }
  template <Enumeration E>
  void fill(E& x, Rule) {
    x = static_cast<E>(whole(random_, 0, Words<E>::texts.size() - 1));
  }
  void fill(double& x, Rule rule) {
    x = real(random_, rule == Rule::kPlain ? -5 : 0, 5);
    if (rule == Rule::kAge && x < 1) x = std::numeric_limits<double>::infinity();
  }
  void fill(Vec3& v, Rule rule) {
    for (double& x : v) x = real(random_, -5, 5);
    if (rule == Rule::kUnit) v.normalize();
    if (rule == Rule::kWeights) v = v.cwiseAbs() / v.cwiseAbs().sum();
  }
  void fill(Quat& q, Rule) {
    for (double& x : q.coeffs()) x = real(random_, -5, 5);
    q.normalize();
  }
  void fill(Mat3& k, Rule) {
    Vec3 a, b;
    fill(a, Rule::kPlain);
    fill(b, Rule::kPlain);
    k = a * a.transpose() + b * b.transpose();
  }
  void fill(std::string& text, Rule rule) {
    if (rule != Rule::kName) {
      text.resize(whole(random_, 0, 200));
      for (char& c : text) c = static_cast<char>(whole(random_, 1, 255));
      return;
    }
    text.resize(whole(random_, 1, kMaxNameBytes));
    for (char& c : text) c = static_cast<char>(whole(random_, 0x20, 0x7e));
    if (text.size() >= 2) text.replace(text.size() - 2, 2, "é");
  }

  Random& random_;
};

/// Makes W as large as the rows want it; one row at least.
inline void mend(Random& random, ContactModel& m) {
  if (m.rows.empty()) m.rows.resize(1);
  const std::size_t size = m.directions() * m.rows.size();
  m.compliance.resize(size * (size + 1) / 2);
  for (double& x : m.compliance) x = real(random, -1, 1);
}

/// Gives each face some nodes; one contact at least.
inline void mend(Random& random, Contacts& m) {
  if (m.contacts.empty()) {
    m.contacts.resize(1);
    m.contacts[0].barycentric = Vec3::UnitX();
  }
  m.face_nodes.clear();
  for (FaceContacts& face : m.faces) {
    face.node_count = static_cast<std::uint32_t>(whole(random, 1, 20));
    for (std::uint32_t i = 0; i < face.node_count; ++i) {
      m.face_nodes.push_back(static_cast<std::uint32_t>(whole(random, 0, 1000)));
    }
  }
}

/// Makes indices exist and differ.
inline void mend(Random& random, SurfaceTopology& m) {
  const std::size_t nodes = m.rest_positions.size() / 3;
  const auto node = [&] { return static_cast<std::uint32_t>(whole(random, 0, nodes - 1)); };
  const auto after = [&](std::uint32_t first, std::size_t steps) {
    return static_cast<std::uint32_t>((first + steps) % nodes);
  };
  m.surface_node_count = static_cast<std::uint32_t>(nodes);
  for (auto& t : m.triangles) {
    t[0] = node();
    t[1] = after(t[0], 1);
    t[2] = after(t[0], 2);
  }
  m.triangle_blocks.resize(m.triangles.size());
  std::uint32_t block = 0;
  for (std::uint32_t& of_triangle : m.triangle_blocks) {
    of_triangle = block;
    block += static_cast<std::uint32_t>(whole(random, 0, 1));
  }
  for (auto& spring : m.springs) {
    spring.node_a = node();
    spring.node_b = after(spring.node_a, 1);
  }
  m.fixed_nodes.resize(nodes / 4);
  for (std::uint32_t& fixed : m.fixed_nodes) fixed = node();
}

inline void mend(NodePositions& m) {
  for (std::size_t i = 0; i + 6 <= m.block_boxes.size(); i += 6) {
    for (std::size_t k = i; k < i + 3; ++k) {
      if (m.block_boxes[k] > m.block_boxes[k + 3])
        std::swap(m.block_boxes[k], m.block_boxes[k + 3]);
    }
  }
}

template <class Message>
void fill(Random& random, Message& message) {
  RandomFiller filler(random);
  describe(filler, message);
  if constexpr (std::same_as<Message, SurfaceTopology>) {
    while (message.rest_positions.size() < 9) message.rest_positions.push_back(1);
    mend(random, message);
  }
  if constexpr (std::same_as<Message, NodePositions>) mend(message);
  if constexpr (std::same_as<Message, Contacts>) mend(random, message);
  if constexpr (std::same_as<Message, ContactModel>) mend(random, message);
}

template <class Message>
Message random_message(Random& random) {
  Message message;
  fill(random, message);
  return message;
}

/// A topology of that many surface nodes, triangles and springs, all indices in range.
inline SurfaceTopology random_topology(Random& random, std::size_t nodes, std::size_t triangles,
                                       std::size_t springs) {
  auto m = random_message<SurfaceTopology>(random);
  m.rest_positions.resize(3 * nodes, 0.5f);
  m.triangles.resize(triangles);
  m.springs.resize(springs);
  mend(random, m);
  return m;
}

template <class Message>
std::vector<std::uint8_t> payload_of(const Message& message) {
  std::vector<std::uint8_t> payload;
  write_payload(message, payload);
  return payload;
}

/// Every bit the same.
template <class Message>
bool equal(const Message& a, const Message& b) {
  return payload_of(a) == payload_of(b);
}

/// Breaks the rule of the `place`-th thing that has one, counted along the description.
class Corrupter {
 public:
  explicit Corrupter(std::size_t place) : left_(place) {}
  /// The field it broke; nullptr if there are fewer places.
  const char* corrupted() const { return corrupted_; }

  void header(Header& h) { describe(*this, h); }
  template <class T>
  void key(const char* name, T& value) {
    field(name, value, Rule::kName);
  }
  template <class T>
  void field(const char* name, T& value, Rule rule) {
    corrupt(name, value, rule);
  }
  template <std::floating_point T>
  void numbers(const char* name, std::vector<T>& list, const Bounds& bounds) {
    for (T& x : list) {
      if (here(name)) x = std::numeric_limits<T>::infinity();
    }
    if (here(name)) list.push_back(0);
    if (bounds.min_entries > 0 && here(name)) list.clear();
  }
  template <class List>
  void numbers(const char* name, List& list, const Bounds& bounds) {
    if (here(name)) list.resize(bounds.max_entries + 1);
  }
  template <class List, class Parts>
  void numbers(const char* name, List& list, const Bounds& bounds, const Parts&) {
    // Two lists from one: the second is as long as the first whatever happens.
    if (bounds.min_entries != bounds.max_entries && here(name)) list.resize(bounds.max_entries + 1);
  }
  template <class List>
  void list(const char* name, List& list, std::size_t max, const char*) {
    for (auto& entry : list) describe(*this, entry);
    if (here(name)) list.resize(max + 1);
  }
  template <class Compute>
  void derived(const char*, const Compute&) {}
  template <class Holds>
  void require(const char*, const Holds&) {}

 private:
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

  // True once, at the place to corrupt.
  bool here(const char* name) {
    if (corrupted_ != nullptr || left_-- > 0) return false;
    corrupted_ = name;
    return true;
  }
  void corrupt(const char* name, std::uint64_t& x, Rule rule) {
    if (rule == Rule::kFromOne && here(name)) x = 0;
    if (rule != Rule::kToken && here(name)) x = kMaxCount + 1;
  }
  void corrupt(const char* name, std::int64_t& x, Rule rule) {
    if (here(name)) x = kMaxTimeNs + 1;
    if (here(name)) x = std::numeric_limits<std::int64_t>::min();
    if (rule == Rule::kAtLeastZero && here(name)) x = -1;
    if (rule == Rule::kSinceSetUp && here(name)) x = -2;
  }
  void corrupt(const char* name, std::uint32_t& x, Rule rule) {
    if (rule == Rule::kFromOne && here(name)) x = 0;
    if (rule == Rule::kForceLimits && here(name)) x = kAllForceLimits + 1;
  }
  void corrupt(const char*, bool&, Rule) {}
  template <Enumeration E>
  void corrupt(const char* name, E& x, Rule) {
    if (here(name)) x = static_cast<E>(Words<E>::texts.size());
  }
  void corrupt(const char* name, double& x, Rule rule) {
    if (here(name)) x = kNan;
    if (rule != Rule::kAge && here(name)) x = std::numeric_limits<double>::infinity();
    if (rule != Rule::kPlain && here(name)) x = -1e-300;
  }
  template <Composed T>
  void corrupt(const char* name, T& value, Rule rule) {
    for_each_number(value, [&](double& x) {
      if (here(name)) x = kNan;
    });
    if (rule == Rule::kPlain) return;
    if (rule == Rule::kSymmetric) {
      if constexpr (Is<T, Mat3>) {
        if (here(name)) value(0, 1) = value(1, 0) + value.cwiseAbs().maxCoeff();
      }
    } else if (here(name)) {
      for_each_number(value, [](double& x) { x *= -1.001; });
    }
  }
  void corrupt(const char* name, std::string& text, Rule rule) {
    if (here(name)) text = std::string(1, '\0');
    if (here(name)) text.assign((rule == Rule::kName ? kMaxNameBytes : kMaxTextBytes) + 1, 'x');
    if (rule == Rule::kName && here(name)) text.clear();
  }

  std::size_t left_;
  const char* corrupted_ = nullptr;
};

}  // namespace palpate::messages::testing
