#include "studies/fuzz/scene_files.h"

#include <fstream>

#include "modules/geometry/mesh_io.h"
#include "studies/report/measures.h"

namespace palpate::fuzz {
namespace {

void write_mesh(scene::Mesh& mesh, const PlacedShape& placed, const ShapeStore& shapes,
                const std::filesystem::path& folder) {
  const auto stem = mesh.file.stem().string();
  mesh.file =
      stem.substr(0, stem.find('_', stem.find('_') + 1)) + "_" + name_of(placed.shape) + ".ply";
  geometry::write_surface(shapes.shape(placed, "mass_spring").surface, folder / mesh.file);
}

}  // namespace

std::filesystem::path write_scene(RandomScene scene, const ShapeStore& shapes,
                                  const std::filesystem::path& folder) {
  report::make_out_folder(folder);
  for (std::size_t i = 0; i < scene.organ_shapes.size(); ++i) {
    write_mesh(scene.scene.organs[i].mesh, scene.organ_shapes[i], shapes, folder);
  }
  for (std::size_t i = 0; i < scene.scene.probes.size(); ++i) {
    scene::Mesh* mesh = mesh_of(scene.scene.probes[i].shape);
    if (mesh != nullptr) write_mesh(*mesh, scene.probe_shapes[i], shapes, folder);
  }
  const auto file = folder / "scene.yaml";
  std::ofstream(file) << text_of(scene);
  return file;
}

}  // namespace palpate::fuzz
