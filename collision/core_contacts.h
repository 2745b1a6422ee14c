// Contacts of rounded cores with an organ's triangles, and which side of the wall a core is on.
//
// An organ is a closed surface whose triangles face outward. A core is normally outside: then
// triangles which it sees from their front are in contact, and triangles it sees from behind (a far
// wall, seen from inside) are not. Once continuous collision detection finds that a core went
// through a triangle from its front, the core is *behind* that wall: the wall keeps its side, so
// its triangles push the core back out the way it came, for as long as the closed surface encloses
// any of the core, between a segment's ends as well, however deep. A core that went right through,
// out of the far side, is dragged back the same way until it is deeper than `depth_limit`. While it
// is behind, only the part of the surface connected with the remembered triangles, near the core
// and facing the same way takes part; it is followed as the core slides. A core inside that no
// sweep saw entering is put behind the wall nearest to it.
//
// Of a finely meshed wall only the part nearest to the core is looked at, some kWallTriangles: all
// of it within the core's reach may be most of an organ.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "collision/closed_surface.h"
#include "collision/core_wall.h"
#include "collision/surface_change.h"
#include "modules/core/state_archive.h"

namespace palpate::collision {

/// Of a wall that a core is behind, about so many are looked at, the nearest. They lie over a
/// sphere of 8 mm behind 39,000 triangles of a stomach, so that it is pushed out straight.
inline constexpr double kWallTriangles = 128;

class CoreContacts {
 public:
  void reset();
  /// What is remembered of an organ is found again on other triangles.
  void change_surface(const SurfaceChange& change);

  /// Begins a step: what was behind after the last one is the memory for this one.
  void begin_step();
  /// Was a wall's part nearer than all that a core may touch, in this step?
  bool wall_was_cut() const { return wall_was_cut_; }
  /// Cores that are behind a wall of the organ, ascending.
  void append_held(std::uint32_t organ, std::vector<std::uint32_t>& cores) const;
  /// Puts a core that is inside the organ, and of which nothing is remembered, behind the wall
  /// nearest to it. @returns whether it did
  bool hold_if_inside(const OrganStep& step, const Core& core);
  /// How far from the core the wall is looked at that it is behind [m]; 0 if it is behind none.
  double wall_reach(const OrganStep& step, const Core& core);
  /// The triangles of it that are remembered; the nearest alone if it was cut.
  void append_remembered(const OrganStep& step, const Core& core,
                         std::vector<std::uint32_t>& triangles) const;
  /// Triangles of the wall that a core is behind, within wall_reach(), and of more than `most` the
  /// nearest.
  void append_near_wall(const OrganStep& step, const Core& core, std::size_t most,
                        std::vector<std::uint32_t>& triangles);

  /// @param candidates  every triangle the core may touch in the step, and those of
  ///                    append_near_wall(); ascending
  void find(const OrganStep& step, const Core& core, std::span<const SweptTriangle> candidates,
            std::vector<FoundContact>& found);

  /// Between two steps.
  void exchange(StateArchive& archive) { archive(now_); }

 private:
  /// `core` is behind `triangle`, which it crossed from the front.
  struct Behind {
    std::uint32_t organ = 0, core = 0, triangle = 0;
    double depth_limit = 0;  ///< down to which it is dragged back through the far side [m]
    double distance = 0;     ///< [m]
    void exchange(StateArchive& archive) { archive(organ, core, triangle, depth_limit, distance); }
  };

  static const Behind& nearest_of(std::span<const Behind> before);
  std::span<const Behind> remembered(std::uint32_t organ, std::uint32_t core) const;
  /// In P; nothing: all along the core is outside.
  std::optional<Vec3> place_inside(const OrganStep& step, const Core& core);
  bool has_left(const OrganStep& step, const Core& core, std::span<const Behind> before);
  void append_nearest_wall(const OrganStep& step, const Core& core, const Vec3& inside,
                           std::vector<FoundContact>& found);
  bool is_new_place(const Core& core, const CoreCandidate& c);
  void find_behind(const OrganStep& step, const Core& core, const std::optional<Vec3>& inside,
                   double depth_limit, std::vector<FoundContact>& found);

  std::vector<Behind> before_, now_;
  bool wall_was_cut_ = false;
  ClosedSurface surface_;
  // Kept between calls for their memory only.
  std::vector<std::uint32_t> waiting_;
  std::vector<std::pair<double, std::uint32_t>> by_distance_;  ///< a heap [m], triangles
  WallBuffers wall_buffers_;
  IndexMarks marks_, places_;
  std::vector<CoreCandidate> near_;
  std::vector<const CoreCandidate*> wall_;
};

}  // namespace palpate::collision
