// From everything the searches found to the list that is handed out.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "collision/relative_motion.h"
#include "modules/core/touch.h"

namespace palpate::collision {

inline constexpr std::uint32_t kNoNode = 0xffffffff;

/// Where a probe may go before its next search: its way ahead, and as far again to any side.
struct ProbeReach {
  Vec3 ahead_P = Vec3::Zero();
  double margin = std::numeric_limits<double>::infinity();  ///< holds twice the way ahead [m]

  /// On the way ahead [m].
  double least_gap(const Contact& c) const {
    return c.gap + std::min(0.0, c.normal_P.dot(ahead_P));
  }
  /// Beside a way that goes on nearly straight, by the tangent of 14° [m].
  double sideways() const { return margin - (2 - 0.25) * ahead_P.norm(); }
  bool may_touch(const Contact& c) const {
    return c.gap <= 0 || c.gap + c.normal_P.dot(ahead_P) + ahead_P.norm() <= margin;
  }
};

/// A contact at the end of the step.
struct FoundContact : Contact {
  /// The nodes with weight > 0, ascending, filled up with kNoNode: the place whatever triangle
  /// names it.
  std::array<std::uint32_t, 3> feature{kNoNode, kNoNode, kNoNode};
};

/// The node or the edge of a triangle that a place lies on, as one number; nothing off them.
inline std::optional<std::uint64_t> node_or_edge(const Vec3& weights,
                                                 const geometry::Triangle& nodes) {
  std::uint32_t low = kNoNode, high = 0;
  bool is_inside = true;
  for (int k = 0; k < 3; ++k) {
    const bool is_on = weights[k] != 0;
    low = std::min(low, is_on ? nodes[k] : kNoNode);
    high = std::max(high, is_on ? nodes[k] : 0);
    is_inside = is_inside && is_on;
  }
  if (is_inside) return {};
  return std::uint64_t{low} << 32 | high;
}

/// Fills in `feature` and appends.
void append_contact(const FoundContact& contact, const geometry::Triangle& nodes,
                    std::vector<FoundContact>& found);

/// Contact at an organ's node, named by the lowest of its triangles.
void append_node_contact(const OrganStep& step, std::uint32_t node, FoundContact contact,
                         std::vector<FoundContact>& found);

/// A plane of the probe that so many nodes of an organ touch is told as a face.
inline constexpr std::size_t kFewestOnFace = 16;
/// Contacts of a sharp probe that are handed out whether the answer needs them or not.
inline constexpr std::size_t kUsualContacts = 1024;
/// Contacts of a round probe with an organ: half of them the deepest, half spread over the others.
/// They say where tissue is; deformation finds its own rows around them (deformation/contact).
inline constexpr std::size_t kMostOfRound = 64;

/// Thins the contacts of a sharp probe from `first` on, which may be millions before the search
/// ends, to all that reduce_contacts() would choose from.
void leave_choice(std::vector<FoundContact>& found, std::size_t first, const ContactLimits& limits,
                  const ProbeReach& reach);

/// Reduces what was found and writes it into result. The same place and normal found twice (over
/// triangles that share it) becomes one contact, of the lowest triangle. Of a round probe,
/// kMostOfRound of an organ are kept. Of others, nodes on one plane become a face, as far as faces
/// and their nodes fit. Where the rest is more than `limits.contacts`, as of a sharp probe in a
/// hurry, which may come to far more than it will, these are kept: what touches and, of each place,
/// the nearest contact that it may come to, up to `limits.needed`; then the nearest of the others
/// while there are fewer than `limits.contacts`. Where more are needed, those are kept that it
/// meets first on its way ahead, and result.truncated says so.
void reduce_contacts(std::vector<FoundContact>& found, bool is_round, const ContactLimits& limits,
                     ContactSet& result, const ProbeReach& reach = {});

}  // namespace palpate::collision
