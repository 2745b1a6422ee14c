#include "modules/messages/message_checks.h"

#include <algorithm>
#include <cmath>

#include "modules/core/text.h"
#include "modules/core/tolerances.h"
#include "modules/messages/describe.h"

namespace palpate::messages {
namespace {

bool is_symmetric(const Mat3& k) {
  return (k - k.transpose()).cwiseAbs().maxCoeff() <= kStiffnessTolerance * k.cwiseAbs().maxCoeff();
}

bool sensible(double x) { return std::abs(x) <= kMaxMagnitude; }  // false for NaN
template <class Matrix>
bool all_sensible(const Matrix& m) {
  return (m.array().abs() <= kMaxMagnitude).all();
}

bool holds(Rule rule, double x) {
  switch (rule) {
    case Rule::kAtLeastZero:
      return sensible(x) && x >= 0;
    case Rule::kAge:
      return x >= 0;
    default:
      return sensible(x);
  }
}
bool holds(Rule rule, const Vec3& v) {
  if (!all_sensible(v)) return false;
  if (rule == Rule::kUnit) return is_unit(v);
  if (rule != Rule::kWeights) return true;
  return v.minCoeff() >= -kUnitTolerance && std::abs(v.sum() - 1) <= kUnitTolerance;
}
bool holds(Rule, const Quat& q) { return is_unit(q); }
bool holds(Rule, const Mat3& k) { return all_sensible(k) && is_symmetric(k); }
bool holds(Rule, bool) { return true; }
bool holds(Rule rule, std::uint64_t x) {
  if (rule == Rule::kToken) return true;
  return x <= kMaxCount && (rule != Rule::kFromOne || x >= 1);
}
bool holds(Rule rule, std::int64_t x) {
  if (x < -kMaxTimeNs || x > kMaxTimeNs) return false;
  if (rule == Rule::kSinceSetUp) return x >= -1;
  return rule != Rule::kAtLeastZero || x >= 0;
}
bool holds(Rule rule, std::uint32_t x) {
  if (rule == Rule::kFromOne) return x >= 1;
  return rule != Rule::kForceLimits || (x & ~kAllForceLimits) == 0;
}
// A zero byte would end the text on the wire. Names are shown everywhere.
bool holds(Rule rule, const std::string& s) {
  const bool name = !s.empty() && s.size() <= kMaxNameBytes && is_utf8(s) && !has_control_bytes(s);
  if (rule == Rule::kName && !name) return false;
  return s.size() <= kMaxTextBytes && s.find('\0') == std::string::npos;
}
template <Enumeration E>
bool holds(Rule, E value) {
  return is_word(value);
}

bool all_hold(const std::vector<float>& values) {
  // Counted, not sought: this loop vectorizes.
  std::uint32_t bad = 0;
  for (const float x : values) bad += std::abs(x) <= float{kMaxMagnitude} ? 0u : 1u;
  return bad == 0;
}
bool all_hold(const std::vector<double>& values) { return std::ranges::all_of(values, sensible); }
template <class List>
bool all_hold(const List&) {
  return true;
}

class Checker {
 public:
  const char* invalid() const { return invalid_; }

  void header(const Header& h) { describe(*this, h); }
  template <class T>
  void key(const char* name, const T& value) {
    field(name, value, Rule::kName);
  }
  template <class T>
  void field(const char* name, const T& value, Rule rule) {
    if (invalid_ == nullptr && !holds(rule, value)) invalid_ = name;
  }
  template <class List>
  void numbers(const char* name, const List& list, const Bounds& bounds) {
    if (invalid_ != nullptr) return;
    using Entry = typename List::value_type;
    const std::size_t width = std::is_arithmetic_v<Entry> ? bounds.numbers_per_entry : 1;
    const std::size_t entries = list.size() / width;
    if (list.size() % width != 0 || !within(entries, bounds) || !all_hold(list)) invalid_ = name;
  }
  template <class List, class Parts>
  void numbers(const char* name, const List& list, const Bounds& bounds, const Parts& parts) {
    if (invalid_ != nullptr) return;
    const bool good = within(list.size(), bounds) && std::ranges::all_of(list, [&](const auto& e) {
                        return std::ranges::all_of(
                            parts(e), [](const auto* part) { return holds(Rule::kPlain, *part); });
                      });
    if (!good) invalid_ = name;
  }
  template <class List>
  void list(const char* name, const List& list, std::size_t max, const char*) {
    if (invalid_ == nullptr && list.size() > max) invalid_ = name;
    for (const auto& entry : list) {
      if (invalid_ != nullptr) return;
      describe(*this, entry);
    }
  }
  template <class Compute>
  void derived(const char*, const Compute&) {}
  template <class Holds>
  void require(const char* name, const Holds& rule) {
    if (invalid_ == nullptr && !rule()) invalid_ = name;
  }

 private:
  static bool within(std::size_t entries, const Bounds& bounds) {
    return entries >= bounds.min_entries && entries <= bounds.max_entries;
  }
  const char* invalid_ = nullptr;
};

}  // namespace

template <class Message>
const char* first_invalid_field(const Message& message) {
  Checker checker;
  describe(checker, message);
  return checker.invalid();
}

#define PALPATE_INSTANTIATE(Message) template const char* first_invalid_field(const Message&);
PALPATE_MESSAGES(PALPATE_INSTANTIATE)
#undef PALPATE_INSTANTIATE

}  // namespace palpate::messages
