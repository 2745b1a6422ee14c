#include "modules/geometry/mesh_io.h"

#include <assimp/BaseImporter.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <fstream>
#include <iterator>
#include <system_error>

#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/core/organ_limits.h"
#include "modules/core/units.h"
#include "modules/geometry/off_file.h"
#include "modules/geometry/ply_file.h"
#include "modules/geometry/weld.h"

namespace palpate::geometry {
namespace {

/// Vertices and faces of a file's meshes as often as it places them: of fifty of the largest
/// organs.
constexpr std::uint64_t kMostPlaced = 50 * (kMaxNodes + kMaxTriangles);

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string() + ": " + what);
}

void check_file(const std::filesystem::path& file) {
  check_input(file, kMaxMeshFileBytes);
  if (std::filesystem::file_size(file) == 0) refuse(file, "is empty");
}

/// By either, as assimp knows a format.
bool is_named_or_begins(const std::filesystem::path& file, const std::string& name,
                        const std::string& word) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return std::tolower(c); });
  std::string first(word.size(), '\0');
  std::ifstream(file, std::ios::binary).read(first.data(), std::ssize(first));
  return extension == name || first == word;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
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

/// Vertices and faces.
std::uint64_t size_of(const aiMesh& mesh) {
  return std::uint64_t{mesh.mNumVertices} + mesh.mNumFaces;
}

std::uint64_t placed_size(const aiScene& scene, const aiNode& node) {
  std::uint64_t size = 0;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) size += size_of(*scene.mMeshes[node.mMeshes[m]]);
  for (unsigned c = 0; c < node.mNumChildren; ++c) size += placed_size(scene, *node.mChildren[c]);
  return size;
}

/// A small file may place a mesh as often as it likes.
void check_placed(const aiScene& scene, const std::filesystem::path& file) {
  std::uint64_t held = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) held += size_of(*scene.mMeshes[m]);
  const std::uint64_t placed = placed_size(scene, *scene.mRootNode);
  const std::uint64_t most = std::max(held, kMostPlaced);
  if (placed <= most) return;
  refuse(file, "places its meshes so often that they have " + std::to_string(placed) +
                   " vertices and faces; at most " + std::to_string(most) + " are allowed");
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

/// It would try them where it does not know a name, and they crash on damaged files.
void leave_out_readers_of_ours(Assimp::Importer& importer) {
  for (const char* const name : {"ply", "off"}) {
    Assimp::BaseImporter* const reader = importer.GetImporter(name);
    if (reader != nullptr && importer.UnregisterLoader(reader) == AI_SUCCESS) delete reader;
  }
}

TriangleSurface read_with_assimp(const std::filesystem::path& file) {
  Assimp::Importer importer;
  leave_out_readers_of_ours(importer);
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    refuse(file, std::string("is not a surface mesh this program reads (") +
                     importer.GetErrorString() +
                     "); allowed: ply, stl, obj, off, gltf, glb, dae, fbx, 3mf, x3d; convert "
                     "VTK or Gmsh files of surfaces to one of these first; a scene takes those of "
                     "tetrahedra as they are");
  }
  check_indices(*scene, file);
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr) refuse(file, "its polygons cannot be triangulated");
  check_placed(*scene, file);
  TriangleSurface surface;
  append_node(*scene, *scene->mRootNode, aiMatrix4x4(), surface);
  return surface;
}

TriangleSurface read_by_format(const std::filesystem::path& file) {
  if (is_named_or_begins(file, ".ply", "ply")) return parse_ply(bytes_of(file), file);
  if (is_named_or_begins(file, ".off", "OFF")) return parse_off(bytes_of(file), file);
  return read_with_assimp(file);
}

}  // namespace

TriangleSurface read_surface(const std::filesystem::path& file, std::string_view unit) {
  const double scale = metres_per_unit(unit);
  check_file(file);
  TriangleSurface surface = read_by_format(file);
  check_content(surface, file);
  for (Vec3& node : surface.nodes) node *= scale;
  weld_nodes(surface);
  return surface;
}

}  // namespace palpate::geometry
