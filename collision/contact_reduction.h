// From everything the searches found to the list that is handed out.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "collision/relative_motion.h"
#include "modules/core/touch.h"

namespace palpate::collision {

inline constexpr std::uint32_t kNoNode = 0xffffffff;

/// A contact in the probe's frame P at the end of the step.
struct FoundContact {
  std::uint32_t organ = 0, triangle = 0;
  /// The nodes with weight > 0, ascending, filled up with kNoNode: the place whatever triangle
  /// names it.
  std::array<std::uint32_t, 3> feature{kNoNode, kNoNode, kNoNode};
  Vec3 weights = Vec3::Zero();
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();
  double gap = 0;
  double time_of_impact = 1;
};

/// Fills in `feature` and appends.
void append_contact(FoundContact contact, const geometry::Triangle& nodes,
                    std::vector<FoundContact>& found);

/// Contact at an organ's node, named by the lowest of its triangles.
void append_node_contact(const OrganStep& step, std::uint32_t node, FoundContact contact,
                         std::vector<FoundContact>& found);

/// The same place and normal found twice (over triangles that share it) becomes one contact, of the
/// lowest triangle. Keeps the deepest `at_most`. Writes them, in W, sorted by
/// (organ, triangle), into result.contacts and result.truncated.
void reduce_contacts(std::vector<FoundContact>& found, const RelativeMotion& motion,
                     std::size_t at_most, ContactSet& result);

}  // namespace palpate::collision
