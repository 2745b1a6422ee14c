// palpate-generate-meshes FOLDER: writes the meshes that ship in scenes/meshes.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"
#include "scenes/meshes/organ_shapes.h"

int main(int argc, char** argv) {
  if (argc != 2 || !std::filesystem::is_directory(argv[1])) {
    std::fprintf(stderr, "usage: palpate-generate-meshes EXISTING_FOLDER\n");
    return palpate::kExitBadInput;
  }
  try {
    for (const auto& [file_name, make] : palpate::meshes::kShippedMeshes) {
      const palpate::geometry::TriangleSurface surface = make();
      palpate::geometry::write_surface(surface, std::filesystem::path(argv[1]) / file_name);
      std::printf("%s: %zu nodes, %zu triangles\n", file_name, surface.nodes.size(),
                  surface.triangles.size());
    }
    return palpate::kExitDone;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return palpate::kExitFailed;
  }
}
