// A number for some of many triangles, nodes or edges, forgotten all at once: its cost is what is
// marked, not the mesh.
#pragma once

#include <cstdint>
#include <vector>

namespace palpate::collision {

class IndexMarks {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// Forgets all. @param count  indices are below this
  void begin(std::size_t count) {
    if (marks_.size() < count) marks_.resize(count);
    ++walk_;
  }
  std::uint32_t at(std::uint32_t index) const {
    const Mark& mark = marks_[index];
    return mark.walk == walk_ ? mark.value : kNone;
  }
  void set(std::uint32_t index, std::uint32_t value) { marks_[index] = {walk_, value}; }

 private:
  struct Mark {
    std::uint64_t walk = 0;
    std::uint32_t value = 0;

    Mark() = default;
    Mark(std::uint64_t in, std::uint32_t number) : walk(in), value(number) {}
  };
  std::vector<Mark> marks_;
  std::uint64_t walk_ = 0;
};

}  // namespace palpate::collision
