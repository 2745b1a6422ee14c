// Node positions as they come: the wire's floats, taken without a copy, or doubles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "modules/core/state_archive.h"
#include "modules/core/types.h"

namespace palpate::collision {

class NodeArray {
 public:
  Vec3 operator[](std::uint32_t node) const {
    if (floats_.empty()) return doubles_[node];
    const float* x = floats_.data() + 3 * std::size_t{node};
    return {x[0], x[1], x[2]};
  }
  std::size_t size() const { return floats_.empty() ? doubles_.size() : floats_.size() / 3; }
  bool empty() const { return size() == 0; }

  void assign(std::span<const Vec3> nodes) {
    floats_.clear();
    doubles_.assign(nodes.begin(), nodes.end());
  }
  /// Exchanges with what was held. @param nodes  three numbers per node [m]
  void swap_in(std::vector<float>& nodes) {
    doubles_.clear();
    floats_.swap(nodes);
  }
  /// Whichever they came as; the other is empty.
  std::span<const float> floats() const { return floats_; }
  std::span<const Vec3> doubles() const { return doubles_; }

  void exchange(StateArchive& archive) { archive(doubles_, floats_); }

 private:
  std::vector<Vec3> doubles_;
  std::vector<float> floats_;
};

}  // namespace palpate::collision
