// Contacts of one rounded core with the triangles near it: seen from their front, touched in
// passing, or of a wall that the core is behind.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "collision/contact_reduction.h"
#include "collision/core_sweep.h"
#include "collision/index_marks.h"

namespace palpate::collision {

/// A triangle belongs to the wall a core is behind if its normal is within 78° of the wall's.
inline constexpr double kSameWall = 0.2;

/// A triangle the core may touch in the step.
struct CoreCandidate {
  const SweptTriangle& triangle;
  geometry::SegmentAndTriangle pair;  ///< at the end
  double side = 0;                    ///< of the core at the end, > 0 in front [m]
  std::optional<Crossing> crossing;   ///< from the front through it
  bool remembered = false;            ///< the core was behind it
  bool on_wall = false;               ///< connected with what the core is behind

  CoreCandidate(const Core& core, const SweptTriangle& swept);
  double gap(const Core& core) const { return pair.distance - core.radius; }
};

/// Did the core go from the front of the triangle through it?
std::optional<Crossing> crossed_inward(const OrganStep& step, const Core& core,
                                       const CoreCandidate& candidate);

/// Nearer than this, rounding turns the direction of a contact [m].
inline constexpr double kSteadyDistance = 1e-4;

/// Core in front of a triangle at the end.
/// @param normal_end  of the triangle, for a core that is on it
void append_front(const OrganStep& step, const Core& core, const geometry::SegmentAndTriangle& pair,
                  std::uint32_t triangle, const geometry::Triangle& nodes, const Vec3& normal_end,
                  std::vector<FoundContact>& found);

/// Contact of the closest approach, carried to the end, for a triangle touched in passing that is
/// now neither in front within the margin nor crossed.
void append_graze(const OrganStep& step, const Core& core, const CoreCandidate& candidate,
                  std::vector<FoundContact>& found);

/// Contact of a core inside with the triangle nearest to it, which pushes it straight out.
void append_nearest(const OrganStep& step, const Core& core, const CoreCandidate& candidate,
                    std::vector<FoundContact>& found);

/// Kept between calls for their memory only.
struct WallBuffers {
  IndexMarks places, seen_nodes;
  std::vector<CoreCandidate*> waiting;
};

/// The depth limit of a core that is inside: its wall is never given up.
inline constexpr double kInside = std::numeric_limits<double>::infinity();

/// Contacts of a core that is behind the wall of the crossed and remembered candidates and of what
/// is connected with them and faces the same way.
/// @param depth_limit  a wall deeper than this is given up [m]
/// @param candidates   ascending
/// @param behind       what it is behind now is appended
void append_wall(const OrganStep& step, const Core& core, double depth_limit,
                 std::vector<CoreCandidate>& candidates, WallBuffers& buffers,
                 std::vector<const CoreCandidate*>& behind, std::vector<FoundContact>& found);

}  // namespace palpate::collision
