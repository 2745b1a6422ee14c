#include "modules/geometry/box_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace palpate::geometry {
namespace {

constexpr std::uint32_t kLeafSize = 4;

}  // namespace

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  branches_.push_back({Box(), 0, static_cast<std::uint32_t>(order_.size()), 0});
  for (std::uint32_t i = 0; i < branches_.size(); ++i) split(i);
}

void BoxTree::split(std::uint32_t branch) {
  const std::uint32_t begin = branches_[branch].begin, end = branches_[branch].end;
  Box box, centres;
  for (std::uint32_t i = begin; i < end; ++i) {
    box.extend(boxes_[order_[i]]);
    centres.extend(boxes_[order_[i]].center());
  }
  branches_[branch].box = box;
  if (end - begin <= kLeafSize) return;
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double at_a = boxes_[a].center()[axis], at_b = boxes_[b].center()[axis];
                     return at_a != at_b ? at_a < at_b : a < b;
                   });
  branches_[branch].left = static_cast<std::uint32_t>(branches_.size());
  branches_.push_back({Box(), begin, middle, 0});
  branches_.push_back({Box(), middle, end, 0});
}

void BoxTree::append_overlapping(const Box& box, std::vector<std::uint32_t>& items) const {
  visit([&](std::uint32_t branch) { return branches_[branch].box.intersects(box); },
        [&](std::uint32_t item) {
          if (boxes_[item].intersects(box)) items.push_back(item);
        });
}

}  // namespace palpate::geometry
