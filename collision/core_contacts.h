// Contacts of rounded cores with an organ's triangles, and which side of the wall a core is on.
//
// An organ is a hollow shell whose triangles face outward. A core is normally outside: then
// triangles which it sees from their front are in contact, and triangles it sees from behind (a far
// wall, seen from inside) are not. Once continuous collision detection finds that a core went
// through a triangle from its front, the core is *behind* that wall: the wall keeps its side, so
// its triangles push the core back out the way it came, until the core is in front of it again, has
// slid off it, has left the organ elsewhere (but for the far side), or is deeper than
// OrganStep::depth_limit (then it counts as outside again). While it is behind, only the part of
// the surface connected with the crossed triangles and facing the same way takes part; it is
// followed as the core slides.
#pragma once

#include <span>
#include <vector>

#include "collision/contact_reduction.h"
#include "collision/core_sweep.h"

namespace palpate::collision {

class CoreContacts {
 public:
  void reset();

  /// Begins a step: what was behind after the last one is the memory for this one.
  void begin_step();
  /// Triangles remembered for any core, and how deep it may be behind them [m].
  void append_remembered(std::uint32_t organ, std::vector<std::uint32_t>& triangles,
                         double& depth_limit) const;
  /// Triangles remembered for one core.
  void append_remembered(std::uint32_t organ, std::uint32_t core,
                         std::vector<std::uint32_t>& triangles) const;

  /// @param candidates  every triangle the core may touch in the step, and all remembered ones
  void find(const OrganStep& step, const Core& core, std::span<const SweptTriangle> candidates,
            std::vector<FoundContact>& found);

 private:
  /// `core` is behind `triangle`, which it crossed from the front.
  struct Behind {
    std::uint32_t organ = 0, core = 0, triangle = 0;
    double depth_limit = 0;  ///< OrganStep::depth_limit of the step that crossed the wall
  };

  std::span<const Behind> remembered(std::uint32_t organ, std::uint32_t core) const;

  std::vector<Behind> before_, now_;
};

}  // namespace palpate::collision
