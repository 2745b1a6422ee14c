#include "studies/fuzz/scene_shapes.h"

namespace palpate::fuzz {
namespace {

geometry::OrganShape shape_in_world(const scene::Organ& organ, const PlacedShape& placed,
                                    const ShapeStore& store) {
  geometry::OrganShape shape = store.shape(placed, organ.model);
  for (auto* nodes : {&shape.surface.nodes, &shape.inner_nodes}) {
    for (Vec3& node : *nodes) node = organ.pose.to_world(node);
  }
  return shape;
}

}  // namespace

session::Assets assets_of(const RandomScene& scene, const ShapeStore& store) {
  session::Assets assets;
  for (std::size_t i = 0; i < scene.organ_shapes.size(); ++i) {
    assets.organs.push_back(shape_in_world(scene.scene.organs[i], scene.organ_shapes[i], store));
  }
  for (std::size_t i = 0; i < scene.scene.probes.size(); ++i) {
    const bool is_mesh = mesh_of(scene.scene.probes[i].shape) != nullptr;
    assets.probe_meshes.push_back(is_mesh
                                      ? store.shape(scene.probe_shapes[i], "mass_spring").surface
                                      : geometry::TriangleSurface{});
  }
  return assets;
}

}  // namespace palpate::fuzz
