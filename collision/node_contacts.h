// Contacts of an organ's nodes with a solid probe (box, half-space, mesh).
//
// A node counts if its wall faces the probe (its outward normal is against the solid's), so nodes
// of a far wall, which the probe would meet from inside the organ, do not. A node that the sweep
// finds entering the solid keeps the face it entered through (its *hold*): while it is inside, or
// in the shadow behind the solid, it is pushed back towards that face, down to
// OrganStep::depth_limit.
#pragma once

#include <span>
#include <vector>

#include "collision/contact_reduction.h"
#include "collision/probe_solid.h"
#include "collision/surface_change.h"
#include "modules/core/state_archive.h"

namespace palpate::collision {

class NodeContacts {
 public:
  void reset();
  /// What is remembered of an organ is found again on other triangles.
  void change_surface(const SurfaceChange& change);
  void begin_step();
  /// Nodes of an organ held since the last step.
  void append_remembered(std::uint32_t organ, std::vector<std::uint32_t>& nodes) const;

  /// @param nodes  each once: every node the solid may touch in the step and all remembered ones
  void find(const OrganStep& step, const ProbeSolid& solid, std::span<const std::uint32_t> nodes,
            std::vector<FoundContact>& found);

  /// Between two steps.
  void exchange(StateArchive& archive) { archive(now_); }

 private:
  struct Hold {
    std::uint32_t organ = 0, node = 0;
    Vec3 point = Vec3::Zero(), outward = Vec3::UnitZ();  ///< of the face, in P
    double depth_limit = 0;  ///< OrganStep::depth_limit of the step that entered it
    void exchange(StateArchive& archive) { archive(organ, node, point, outward, depth_limit); }
  };

  /// A plane of the probe's surface, in P.
  struct Face {
    Vec3 point, outward;
    double height(const Vec3& x) const { return outward.dot(x - point); }
  };
  struct Kept {
    Face face;
    double depth_limit = 0;  ///< [m]
  };
  struct SweptNode {
    std::uint32_t index = 0;
    Vec3 end;
    std::optional<SolidPoint> near;
    std::optional<SolidEntry> entry;
  };

  /// The face a node is pushed back in front of while it is inside the solid or in its shadow.
  std::optional<Kept> kept_face(const OrganStep& step, const SweptNode& node) const;
  const Hold* held(const OrganStep& step, std::uint32_t node) const;
  void find_node(const OrganStep& step, const ProbeSolid& solid, std::uint32_t node,
                 std::vector<FoundContact>& found);

  std::vector<Hold> before_, now_;  ///< sorted by (organ, node)
};

}  // namespace palpate::collision
