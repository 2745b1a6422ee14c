#include "collision/probe_model.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "modules/geometry/inner_lines.h"
#include "modules/geometry/primitives.h"

namespace palpate::collision {
namespace {

struct Builder {
  ProbeModel& model;

  void operator()(const geometry::RoundedSegment& core) const {
    model.cores = {Core{0, core.a, core.b, core.radius}};
    // The ends are cores of their own: an axis lying on a flat place gives one of many closest
    // points.
    if (!core.is_ball()) {
      model.cores.push_back(Core{1, core.a, core.a, core.radius});
      model.cores.push_back(Core{2, core.b, core.b, core.radius});
    }
    model.is_round = core.is_ball() && core.a.isZero(0);
    set_hull({core.a.cwiseMin(core.b), core.a.cwiseMax(core.b)}, core.radius);
    model.reach = core.radius + std::max(core.a.norm(), core.b.norm());
  }
  void operator()(const geometry::Box& box) const {
    model.sharp = std::make_unique<SharpMesh>(geometry::make_box(box.size));
    model.solid = make_box_solid(box.size);
    set_hull({-0.5 * box.size, 0.5 * box.size}, 0);
    model.reach = 0.5 * box.size.norm();
  }
  void operator()(const geometry::HalfSpace&) const {
    model.solid = make_half_space();
    model.is_bounded = false;
    model.hull = {Vec3::Constant(-1e300), Vec3(1e300, 1e300, 0)};
    model.max_tracked_penetration = std::numeric_limits<double>::infinity();
  }
  void operator()(geometry::TriangleSurface& surface) const {
    model.sharp = std::make_unique<SharpMesh>(std::move(surface));
    model.solid = make_mesh_solid(*model.sharp);
    for (const Vec3& x : model.sharp->vertices()) model.reach = std::max(model.reach, x.norm());
    set_hull(model.sharp->bounds(), 0);
  }

  void set_hull(const Bounds& box, double radius) const {
    model.hull = box;
    model.hull_radius = radius;
    model.max_tracked_penetration = (box.upper - box.lower).maxCoeff() + 2 * radius;
  }
};

}  // namespace

ProbeModel::ProbeModel(geometry::ProbeForm form) {
  const std::vector<geometry::RoundedSegment> within = geometry::inner_lines(form);
  std::visit(Builder{*this}, form);
  for (const geometry::RoundedSegment& line : within) {
    const auto index = static_cast<std::uint32_t>(sharp->vertices().size() + lines.size());
    lines.push_back({index, line.a, line.b, line.radius});
  }
}

Core ProbeModel::core(std::uint32_t index) const {
  if (!sharp) return cores[index];
  const std::size_t corners = sharp->vertices().size();
  if (index >= corners) return lines[index - corners];
  const Vec3& x = sharp->vertices()[index];
  return {index, x, x, 0};
}

}  // namespace palpate::collision
