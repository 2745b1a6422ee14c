#include "modules/geometry/mesh_io.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <fstream>
#include <iterator>
#include <system_error>

#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/core/units.h"
#include "modules/geometry/ply_file.h"
#include "modules/geometry/weld.h"

namespace palpate::geometry {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string() + ": " + what);
}

void check_file(const std::filesystem::path& file) {
  check_input(file, kMaxMeshFileBytes);
  if (std::filesystem::file_size(file) == 0) refuse(file, "is empty");
}

/// By its name or its first word: assimp would know it by either.
bool is_ply(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return std::tolower(c); });
  std::array<char, 3> first{};
  std::ifstream(file, std::ios::binary).read(first.data(), first.size());
  return extension == ".ply" || first == std::array{'p', 'l', 'y'};
}

TriangleSurface read_ply(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  return parse_ply(bytes, file);
}

/// assimp leaves bad indices to its post-processing, which would read past the end.
void check_indices(const aiScene& scene, const std::filesystem::path& file) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      for (unsigned i = 0; i < mesh.mFaces[f].mNumIndices; ++i) {
        if (mesh.mFaces[f].mIndices[i] >= mesh.mNumVertices) {
          refuse(file, "face " + std::to_string(f) + " names vertex " +
                           std::to_string(mesh.mFaces[f].mIndices[i]) + "; allowed: 0 to " +
                           std::to_string(mesh.mNumVertices - 1));
        }
      }
    }
  }
}

/// Its OFF reader announces polygons where there are none, and its triangulation asserts on that.
void correct_announcements(const aiScene& scene) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    aiMesh& mesh = *scene.mMeshes[m];
    bool any = false;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) any |= mesh.mFaces[f].mNumIndices > 3;
    if (!any) mesh.mPrimitiveTypes &= ~static_cast<unsigned>(aiPrimitiveType_POLYGON);
  }
}

void append_mesh(const aiMesh& mesh, const aiMatrix4x4& to_file, TriangleSurface& surface) {
  const auto offset = static_cast<std::uint32_t>(surface.nodes.size());
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D p = to_file * mesh.mVertices[v];
    surface.nodes.push_back({p.x, p.y, p.z});
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;  // points and lines hold no volume
    surface.triangles.push_back(
        {offset + face.mIndices[0], offset + face.mIndices[1], offset + face.mIndices[2]});
  }
}

void append_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent_to_file,
                 TriangleSurface& surface) {
  const aiMatrix4x4 to_file = parent_to_file * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    append_mesh(*scene.mMeshes[node.mMeshes[m]], to_file, surface);
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) {
    append_node(scene, *node.mChildren[c], to_file, surface);
  }
}

void check_content(const TriangleSurface& surface, const std::filesystem::path& file) {
  if (surface.triangles.empty()) refuse(file, "holds no triangles");
  for (std::size_t i = 0; i < surface.nodes.size(); ++i) {
    if (!surface.nodes[i].allFinite()) {
      refuse(file, "vertex " + std::to_string(i) + " is not finite");
    }
  }
}

TriangleSurface read_with_assimp(const std::filesystem::path& file) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    refuse(file, std::string("is not a surface mesh this program reads (") +
                     importer.GetErrorString() +
                     "); allowed: ply, stl, obj, off, gltf, glb, dae, fbx, 3mf, x3d; convert "
                     "tetrahedra and VTK or Gmsh files to one of these first");
  }
  check_indices(*scene, file);
  correct_announcements(*scene);
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr) refuse(file, "its polygons cannot be triangulated");
  TriangleSurface surface;
  append_node(*scene, *scene->mRootNode, aiMatrix4x4(), surface);
  return surface;
}

}  // namespace

TriangleSurface read_surface(const std::filesystem::path& file, std::string_view unit) {
  const double scale = metres_per_unit(unit);
  check_file(file);
  TriangleSurface surface = is_ply(file) ? read_ply(file) : read_with_assimp(file);
  check_content(surface, file);
  for (Vec3& node : surface.nodes) node *= scale;
  weld_nodes(surface);
  return surface;
}

}  // namespace palpate::geometry
