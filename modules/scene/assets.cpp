#include "modules/scene/assets.h"

#include <variant>

#include "modules/core/error.h"
#include "modules/geometry/mesh_prepare.h"

namespace palpate::scene {
namespace {

geometry::TriangleSurface load(const Mesh& mesh, const std::string& owner) {
  try {
    return geometry::load_organ_surface(mesh.file, mesh.unit, mesh.nodes);
  } catch (const InputError& error) {
    throw InputError(owner + ": " + error.what());
  }
}

}  // namespace

geometry::TriangleSurface load_organ(const Organ& organ) {
  auto surface = load(organ.mesh, "organ '" + organ.name + "'");
  for (Vec3& node : surface.nodes) node = organ.pose.to_world(node);
  return surface;
}

geometry::TriangleSurface load_probe_mesh(const Probe& probe) {
  const auto* shape = std::get_if<MeshShape>(&probe.shape);
  if (shape == nullptr) return {};
  return load(shape->mesh, "probe '" + probe.name + "'");
}

}  // namespace palpate::scene
