// palpate-generate-meshes FOLDER: writes the meshes that ship in scenes/meshes.
#include <cstdio>
#include <filesystem>

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"
#include "modules/runtime/program.h"
#include "scenes/meshes/organ_shapes.h"

int main(int argc, char** argv) {
  palpate::runtime::Program program("Writes the meshes that ship in scenes/meshes.",
                                    "palpate-generate-meshes");
  std::filesystem::path folder;
  program.add("FOLDER", folder, "Where to; it must exist").required();
  return program.run(argc, argv, [&] {
    if (!std::filesystem::is_directory(folder)) {
      throw palpate::InputError(folder.string() + ": no such folder");
    }
    for (const auto& [file_name, make] : palpate::meshes::kShippedMeshes) {
      const palpate::geometry::TriangleSurface surface = make();
      palpate::geometry::write_surface(surface, folder / file_name);
      std::printf("%s: %zu nodes, %zu triangles\n", file_name, surface.nodes.size(),
                  surface.triangles.size());
    }
    return palpate::kExitDone;
  });
}
