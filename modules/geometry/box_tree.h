// A tree of axis-aligned boxes that do not change.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate::geometry {

class BoxTree {
 public:
  using Box = Eigen::AlignedBox3d;

  explicit BoxTree(std::vector<Box> boxes);

  struct Branch {
    Box box;
    std::uint32_t begin = 0, end = 0;  ///< of all items below it, in their order
    std::uint32_t left = 0;            ///< children at left and left + 1; 0: a leaf
  };
  /// A branch comes before its children, the root first.
  std::span<const Branch> branches() const { return branches_; }
  std::span<const std::uint32_t> items_of(const Branch& branch) const {
    return std::span(order_).subspan(branch.begin, branch.end - branch.begin);
  }
  std::span<const Box> boxes() const { return boxes_; }

  /// Calls visit(item) for the items of the leaves of which, and of all branches that lead to
  /// which, opens(index) is true; in no useful order.
  template <class Opens, class Visit>
  void visit(const Opens& opens, const Visit& visit) const {
    std::array<std::uint32_t, kMostWaiting> open;
    std::size_t waiting = 1;
    open[0] = 0;
    while (waiting > 0) {
      const std::uint32_t index = open[--waiting];
      if (!opens(index)) continue;
      const Branch& branch = branches_[index];
      if (branch.left != 0) {
        open[waiting++] = branch.left + 1;
        open[waiting++] = branch.left;
        continue;
      }
      for (const std::uint32_t item : items_of(branch)) visit(item);
    }
  }

  /// Calls visit(item) for all items that may be within a limit of something, nearer boxes first.
  /// @param squared_distance  (Box) -> at most that of anything in it [m²]
  /// @param squared_limit     () -> the limit, which a visit may have lowered [m²]
  template <class Distance, class Limit, class Visit>
  void visit_near(const Distance& squared_distance, const Limit& squared_limit,
                  const Visit& visit) const {
    struct Open {
      std::uint32_t branch;
      double squared;
    };
    std::array<Open, kMostWaiting> open;
    std::size_t waiting = 1;
    open[0] = {0, squared_distance(branches_[0].box)};
    while (waiting > 0) {
      const Open& next = open[--waiting];
      if (next.squared > squared_limit()) continue;
      const Branch& branch = branches_[next.branch];
      if (branch.left == 0) {
        for (const std::uint32_t item : items_of(branch)) visit(item);
        continue;
      }
      const std::uint32_t left = branch.left, right = branch.left + 1;
      const Open to_left{left, squared_distance(branches_[left].box)};
      const Open to_right{right, squared_distance(branches_[right].box)};
      const bool left_first = to_left.squared <= to_right.squared;
      open[waiting++] = left_first ? to_right : to_left;
      open[waiting++] = left_first ? to_left : to_right;
    }
  }

  /// Appends the items whose boxes touch `box`, in no useful order.
  void append_overlapping(const Box& box, std::vector<std::uint32_t>& items) const;

 private:
  /// Depth first: at most one waiting branch per halving.
  static constexpr std::size_t kMostWaiting = 64;

  void split(std::uint32_t branch);

  std::vector<Box> boxes_;            // of each item
  std::vector<std::uint32_t> order_;  // items, each branch's side by side
  std::vector<Branch> branches_;
};

}  // namespace palpate::geometry
