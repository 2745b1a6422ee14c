// From everything the searches found to the list that is handed out.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "collision/relative_motion.h"
#include "modules/core/touch.h"

namespace palpate::collision {

inline constexpr std::uint32_t kNoNode = 0xffffffff;

/// A contact at the end of the step.
struct FoundContact : Contact {
  /// The nodes with weight > 0, ascending, filled up with kNoNode: the place whatever triangle
  /// names it.
  std::array<std::uint32_t, 3> feature{kNoNode, kNoNode, kNoNode};
};

/// Fills in `feature` and appends.
void append_contact(FoundContact contact, const geometry::Triangle& nodes,
                    std::vector<FoundContact>& found);

/// Contact at an organ's node, named by the lowest of its triangles.
void append_node_contact(const OrganStep& step, std::uint32_t node, FoundContact contact,
                         std::vector<FoundContact>& found);

/// The same place and normal found twice (over triangles that share it) becomes one contact, of the
/// lowest triangle. Keeps the deepest `at_most`. Writes them, sorted by (organ, triangle), into
/// result.contacts and result.truncated.
void reduce_contacts(std::vector<FoundContact>& found, std::size_t at_most, ContactSet& result);

}  // namespace palpate::collision
