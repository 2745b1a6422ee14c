// Whether several programs move one probe: its pose then jumps between theirs.
#pragma once

#include <array>
#include <cstdint>

namespace palpate::haptics {

/// One that stops and another that begins are a driver and its successor; one that speaks again
/// after another did is not alone. In the haptic loop: no allocation.
class DriverWatch {
 public:
  /// So long one that spoke is remembered, and several are said to be there [ns].
  static constexpr std::int64_t kRemembered = 1'000'000'000;

  using Writer = std::array<unsigned char, 16>;  ///< unique among all that ever were

  void hear(const Writer& writer, std::int64_t now_ns) {
    std::size_t place = 0;
    while (place + 1 < heard_.size() && heard_[place].writer != writer) ++place;
    if (place > 0 && heard_[place].writer == writer && is_recent(heard_[place].at_ns, now_ns)) {
      several_at_ns_ = now_ns;
    }
    for (; place > 0; --place) heard_[place] = heard_[place - 1];
    heard_[0] = {writer, now_ns};
  }
  bool several(std::int64_t now_ns) const { return is_recent(several_at_ns_, now_ns); }

 private:
  struct Heard {
    Writer writer{};
    std::int64_t at_ns = kNever;
  };
  static constexpr std::int64_t kNever = -1;
  static bool is_recent(std::int64_t at_ns, std::int64_t now_ns) {
    return at_ns != kNever && now_ns - at_ns <= kRemembered;
  }

  std::array<Heard, 4> heard_;  ///< the last one first
  std::int64_t several_at_ns_ = kNever;
};

}  // namespace palpate::haptics
