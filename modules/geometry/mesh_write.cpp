// The writing half of mesh_io.h. Our own writers: assimp's exporters split and reorder nodes.
#include <algorithm>
#include <bit>
#include <cctype>
#include <iomanip>
#include <limits>
#include <string>

#include "modules/core/error.h"
#include "modules/core/whole_file.h"
#include "modules/geometry/gmsh_file.h"
#include "modules/geometry/mesh_io.h"

namespace palpate::geometry {
namespace {

static_assert(std::endian::native == std::endian::little, "binary formats are little-endian");

template <typename T>
void put(std::ostream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_floats(std::ostream& out, const Vec3& value) {
  for (int axis = 0; axis < 3; ++axis) put(out, static_cast<float>(value[axis]));
}

void write_ply(const TriangleSurface& surface, std::ostream& out) {
  out << "ply\nformat binary_little_endian 1.0\ncomment palpate organ surface, metres\n"
      << "element vertex " << surface.nodes.size()
      << "\nproperty float x\nproperty float y\nproperty float z\n"
      << "element face " << surface.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3& node : surface.nodes) put_floats(out, node);
  for (const Triangle& triangle : surface.triangles) {
    put(out, std::uint8_t{3});
    for (const std::uint32_t node : triangle) put(out, static_cast<std::int32_t>(node));
  }
}

void write_stl(const TriangleSurface& surface, std::ostream& out) {
  char heading[80] = "palpate organ surface, metres";
  out.write(heading, sizeof heading);
  put(out, static_cast<std::uint32_t>(surface.triangles.size()));
  for (const Triangle& triangle : surface.triangles) {
    put_floats(out, area_vector(surface.nodes, triangle).normalized());
    for (const std::uint32_t node : triangle) put_floats(out, surface.nodes[node]);
    put(out, std::uint16_t{0});
  }
}

void write_nodes_as_text(const TriangleSurface& surface, const char* prefix, std::ostream& out) {
  out << std::setprecision(std::numeric_limits<float>::max_digits10);
  for (const Vec3& node : surface.nodes) {
    out << prefix << node.x() << ' ' << node.y() << ' ' << node.z() << '\n';
  }
}

void write_obj(const TriangleSurface& surface, std::ostream& out) {
  out << "# palpate organ surface, metres\n";
  write_nodes_as_text(surface, "v ", out);
  for (const auto& [a, b, c] : surface.triangles) {
    out << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  }
}

void write_off(const TriangleSurface& surface, std::ostream& out) {
  out << "OFF\n" << surface.nodes.size() << ' ' << surface.triangles.size() << " 0\n";
  write_nodes_as_text(surface, "", out);
  for (const auto& [a, b, c] : surface.triangles) {
    out << "3 " << a << ' ' << b << ' ' << c << '\n';
  }
}

[[noreturn]] void refuse_format(const std::filesystem::path& file, const std::string& allowed) {
  throw InputError(file.string() + ": cannot write the format '" + file.extension().string() +
                   "'; allowed: " + allowed);
}

using Writer = void (*)(const TriangleSurface&, std::ostream&);

/// In lower case, as when a file is read.
std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return std::tolower(c); });
  return extension;
}

Writer writer_for(const std::filesystem::path& file) {
  const std::string extension = extension_of(file);
  if (extension == ".ply") return write_ply;
  if (extension == ".stl") return write_stl;
  if (extension == ".obj") return write_obj;
  if (extension == ".off") return write_off;
  refuse_format(file, ".ply, .stl, .obj, .off; tetrahedra (.msh) come of --near");
}

template <class Write>
void write_whole(const std::filesystem::path& file, const Write& write) {
  WholeFile whole(file);
  write(whole.stream());
  whole.finish();
}

}  // namespace

void check_can_write(const std::filesystem::path& file) { writer_for(file); }

void check_can_write_tetrahedra(const std::filesystem::path& file) {
  if (extension_of(file) != ".msh") refuse_format(file, ".msh, for --near makes tetrahedra");
}

void write_surface(const TriangleSurface& surface, const std::filesystem::path& file) {
  const Writer writer = writer_for(file);
  write_whole(file, [&](std::ostream& out) { writer(surface, out); });
}

void write_tetrahedra(const TetMesh& mesh, const std::filesystem::path& file) {
  check_can_write_tetrahedra(file);
  write_whole(file, [&](std::ostream& out) { write_gmsh(mesh, out); });
}

}  // namespace palpate::geometry
