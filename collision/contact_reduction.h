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

/// A plane of the probe that so many nodes of an organ touch is told as a face.
inline constexpr std::size_t kFewestOnFace = 16;
/// Contacts of a round probe with an organ: half of them the deepest, half spread over the others.
/// They say where tissue is; deformation finds its own rows around them (deformation/contact).
inline constexpr std::size_t kMostOfRound = 64;
/// More than these are thinned first: to so many deepest, and one in each of so many cells along
/// each axis.
inline constexpr std::size_t kThinnedDeepest = 128, kThinnedCells = 4;

/// The same place and normal found twice (over triangles that share it) becomes one contact, of the
/// lowest triangle. And they are reduced: of a round probe to kMostOfRound of an organ; of others
/// nodes on one plane become a face, as far as faces and their nodes fit. Where the rest is more
/// than `limits.contacts`, as of a sharp probe in a hurry, which may come to far more than it will,
/// what does not touch is left out where another contact of the same place is nearer, the farthest
/// first. Where that is not enough the deepest are kept and result.truncated says so. Writes them
/// into result.
void reduce_contacts(std::vector<FoundContact>& found, bool is_round, const ContactLimits& limits,
                     ContactSet& result);

}  // namespace palpate::collision
