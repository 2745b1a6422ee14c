#include "collision/probe_model.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "modules/geometry/primitives.h"

namespace palpate::collision {
namespace {

struct Builder {
  ProbeModel& model;
  geometry::TriangleSurface& mesh;

  void operator()(const scene::SphereShape& sphere) const {
    model.cores = {Core{0, Vec3::Zero(), Vec3::Zero(), sphere.radius}};
    model.is_round = true;
    set_bounds(Vec3::Constant(sphere.radius));
    model.reach = sphere.radius;
  }
  void operator()(const scene::CapsuleShape& capsule) const {
    const Vec3 end = 0.5 * capsule.length * Vec3::UnitZ();
    // The ends are cores of their own: an axis lying on a flat place gives one of many closest
    // points.
    model.cores = {Core{0, -end, end, capsule.radius}, Core{1, -end, -end, capsule.radius},
                   Core{2, end, end, capsule.radius}};
    set_bounds(Vec3::Constant(capsule.radius) + end);
    model.reach = capsule.radius + end.norm();
  }
  void operator()(const scene::BoxShape& box) const {
    model.sharp = std::make_unique<SharpMesh>(geometry::make_box(box.size));
    model.solid = make_box_solid(box.size);
    set_bounds(0.5 * box.size);
    model.reach = 0.5 * box.size.norm();
  }
  void operator()(const scene::PlaneShape&) const {
    model.solid = make_half_space();
    model.is_bounded = false;
    model.depth_believed = std::numeric_limits<double>::infinity();
  }
  void operator()(const scene::MeshShape&) const {
    model.sharp = std::make_unique<SharpMesh>(std::move(mesh));
    model.solid = make_mesh_solid(*model.sharp);
    model.bounds = model.sharp->bounds();
    for (const Vec3& x : model.sharp->vertices()) model.reach = std::max(model.reach, x.norm());
    set_depth();
  }

  void set_bounds(const Vec3& half) const {
    model.bounds = {-half, half};
    set_depth();
  }
  void set_depth() const {
    model.depth_believed = (model.bounds.upper - model.bounds.lower).maxCoeff();
  }
};

}  // namespace

ProbeModel::ProbeModel(ProbeGeometry probe) { std::visit(Builder{*this, probe.mesh}, probe.shape); }

}  // namespace palpate::collision
