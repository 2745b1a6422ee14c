// A number for some of many triangles, nodes or edges, forgotten all at once: its cost, in time and
// in memory, is what is marked, not the mesh.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace palpate::collision {

class IndexMarks {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// Forgets all.
  void begin() {
    used_ = 0;
    if (walk_ == std::numeric_limits<std::uint32_t>::max()) {
      marks_.assign(marks_.size(), {});
      walk_ = 0;
    }
    ++walk_;
  }
  std::uint32_t at(std::uint64_t index) const {
    const Mark& mark = marks_[place_of(index)];
    return mark.walk == walk_ ? mark.value : kNone;
  }
  void set(std::uint64_t index, std::uint32_t value) {
    std::size_t place = place_of(index);
    if (marks_[place].walk != walk_ && 2 * ++used_ > marks_.size()) {
      grow();
      place = place_of(index);
    }
    marks_[place] = {index, walk_, value};
  }
  /// Unless it has one. @returns the one it had, or kNone
  std::uint32_t add(std::uint64_t index, std::uint32_t value) {
    Mark& mark = marks_[place_of(index)];
    if (mark.walk == walk_) return mark.value;
    if (2 * (used_ + 1) > marks_.size()) {
      set(index, value);
    } else {
      ++used_;
      mark = {index, walk_, value};
    }
    return kNone;
  }

 private:
  /// Free unless of this walk.
  struct Mark {
    std::uint64_t index = 0;
    std::uint32_t walk = 0, value = 0;
  };

  /// Where the index is, or would be: the next free place after one that looks random.
  std::size_t place_of(std::uint64_t index) const {
    std::size_t place = (index * 0x9e3779b97f4a7c15u) >> (64 - std::bit_width(marks_.size() - 1));
    while (marks_[place].walk == walk_ && marks_[place].index != index) {
      place = (place + 1) & (marks_.size() - 1);
    }
    return place;
  }
  void grow() {
    const std::vector<Mark> before(std::move(marks_));
    marks_.assign(2 * before.size(), {});
    for (const Mark& mark : before) {
      if (mark.walk == walk_) marks_[place_of(mark.index)] = mark;
    }
  }

  std::vector<Mark> marks_ = std::vector<Mark>(256);  ///< a power of two, at most half of it used
  std::uint32_t walk_ = 1;
  std::size_t used_ = 0;
};

}  // namespace palpate::collision
