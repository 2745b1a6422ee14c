#include "studies/fuzz/scene_shapes.h"

namespace palpate::fuzz {

std::vector<geometry::OrganShape> shapes_in_world(const RandomScene& scene,
                                                  const ShapeStore& store) {
  std::vector<geometry::OrganShape> shapes;
  shapes.reserve(scene.organ_shapes.size());
  for (std::size_t i = 0; i < scene.organ_shapes.size(); ++i) {
    const scene::Organ& organ = scene.scene.organs[i];
    shapes.push_back(store.shape(scene.organ_shapes[i], organ.model));
    for (auto* nodes : {&shapes[i].surface.nodes, &shapes[i].inner_nodes}) {
      for (Vec3& node : *nodes) node = organ.pose.to_world(node);
    }
  }
  return shapes;
}

std::vector<collision::ProbeGeometry> probe_geometry(const RandomScene& scene,
                                                     const ShapeStore& store) {
  std::vector<collision::ProbeGeometry> geometry;
  geometry.reserve(scene.scene.probes.size());
  for (std::size_t i = 0; i < scene.scene.probes.size(); ++i) {
    const auto& shape = scene.scene.probes[i].shape;
    geometry.push_back({shape, {}});
    if (!std::holds_alternative<scene::MeshShape>(shape)) continue;
    geometry.back().mesh = store.shape(scene.probe_shapes[i], scene::Model::kMassSpring).surface;
  }
  return geometry;
}

}  // namespace palpate::fuzz
