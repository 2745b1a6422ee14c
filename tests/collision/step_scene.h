// One organ and one step, for tests of the single searches. P is the world at the end of the step.
#pragma once

#include "collision/contact_reduction.h"
#include "tests/collision/random_shapes.h"

namespace palpate::collision {

/// The organ comes towards the probe, which rests at the origin, by `way`.
struct StepScene {
  OrganSurface organ;
  RelativeMotion motion;
  OrganStep step;

  StepScene(const geometry::TriangleSurface& surface, const Vec3& way, double margin = 0.1,
            double depth_limit = 10)
      : organ(surface.triangles),
        motion({{way, Quat::Identity()}, {}}, 1, false),
        step{0, organ, motion, 0, margin, depth_limit} {
    organ.update(surface.nodes);
  }

  std::vector<SweptTriangle> triangles() const {
    std::vector<SweptTriangle> result;
    SweptTriangle triangle;
    for (std::uint32_t t = 0; t < organ.triangles().size(); ++t) {
      if (step.sweep(t, triangle)) result.push_back(triangle);
    }
    return result;
  }
  std::vector<std::uint32_t> nodes() const {
    std::vector<std::uint32_t> result(organ.node_count());
    for (std::uint32_t i = 0; i < result.size(); ++i) result[i] = i;
    return result;
  }
};

/// A box around the origin moved by `by`.
inline geometry::TriangleSurface box_at(const Vec3& by, const Vec3& size, int divisions = 1) {
  geometry::TriangleSurface box = geometry::make_box(size, divisions);
  for (Vec3& x : box.nodes) x += by;
  return box;
}

}  // namespace palpate::collision
