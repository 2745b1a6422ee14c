#include "modules/scene/probe_shape.h"

#include <utility>

#include "modules/geometry/primitives.h"

namespace palpate::scene {
namespace {

using geometry::ProbeForm;

struct Form {
  geometry::TriangleSurface& mesh;

  ProbeForm operator()(const SphereShape& sphere) const {
    return geometry::RoundedSegment{Vec3::Zero(), Vec3::Zero(), sphere.radius};
  }
  ProbeForm operator()(const CapsuleShape& capsule) const {
    const Vec3 end(0, 0, 0.5 * capsule.length);
    return geometry::RoundedSegment{-end, end, capsule.radius};
  }
  ProbeForm operator()(const BoxShape& box) const { return geometry::Box{box.size}; }
  ProbeForm operator()(const ConeShape& cone) const {
    return geometry::make_cone(cone.radius, cone.length);
  }
  ProbeForm operator()(const GrasperShape& jaws) const {
    return geometry::make_jaws(jaws.length, jaws.width, jaws.thickness, jaws.opening);
  }
  ProbeForm operator()(const PlaneShape&) const { return geometry::HalfSpace{}; }
  ProbeForm operator()(const MeshShape&) const { return std::move(mesh); }
};

template <class Shape>
auto* named_mesh(Shape& shape) {
  auto* named = std::get_if<MeshShape>(&shape);
  return named != nullptr ? &named->mesh : nullptr;
}

}  // namespace

ProbeForm form_of(const ProbeShape& shape, geometry::TriangleSurface mesh) {
  return std::visit(Form{mesh}, shape);
}

Mesh* mesh_of(ProbeShape& shape) { return named_mesh(shape); }
const Mesh* mesh_of(const ProbeShape& shape) { return named_mesh(shape); }

}  // namespace palpate::scene
