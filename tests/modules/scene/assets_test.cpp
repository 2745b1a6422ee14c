#include "modules/scene/assets.h"

#include <fstream>
#include <numbers>

#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/tetrahedra.h"
#include "tests/modules/scene/scene_text.h"

using namespace palpate;
using namespace palpate::scene;
using namespace palpate::scene::test;

namespace {

// Mesh files are read as floats: 6e-8 relative, at 0.1 m.
constexpr double kFileRounding = 1e-8;

Organ box_organ(const ScratchFolder& folder) {
  Organ organ;
  organ.name = "cube";
  organ.mesh.file = folder.path() / "cube.off";
  geometry::write_surface(geometry::make_box(Vec3(0.04, 0.06, 0.08)), organ.mesh.file);
  return organ;
}

/// Lowest and highest corner.
std::array<Vec3, 2> extent(const geometry::TriangleSurface& surface) {
  std::array<Vec3, 2> result{surface.nodes.at(0), surface.nodes.at(0)};
  for (const Vec3& node : surface.nodes) {
    result[0] = result[0].cwiseMin(node);
    result[1] = result[1].cwiseMax(node);
  }
  return result;
}

/// A block of tetrahedra, 8 cm a side, 2 cm an edge, in a file.
Organ block_organ(const ScratchFolder& folder) {
  const auto mesh = geometry::testing::block({0.08, 0.08, 0.08}, 4, 4, 4);
  Organ organ;
  organ.name = "block";
  organ.model = "nodal_pressure";
  organ.mesh.file = folder.path() / "block.vtk";
  std::ofstream file(organ.mesh.file);
  file << "# vtk DataFile Version 2.0\nblock\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS "
       << mesh.nodes.size() << " double\n";
  for (const Vec3& x : mesh.nodes) file << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  file << "CELLS " << mesh.tetrahedra.size() << ' ' << 5 * mesh.tetrahedra.size() << '\n';
  for (const auto& [a, b, c, d] : mesh.tetrahedra) {
    file << "4 " << a << ' ' << b << ' ' << c << ' ' << d << '\n';
  }
  file << "CELL_TYPES " << mesh.tetrahedra.size() << '\n';
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) file << "10\n";
  return organ;
}

}  // namespace

TEST_CASE("assets: tetrahedra are small near the regions that a solid is refined at, in W") {
  // Oracle: definition, at the middle of each edge; corners alone count of quadratic tetrahedra.
  const ScratchFolder folder;
  Organ organ = block_organ(folder);
  organ.pose.position = Vec3(0.1, 0, 0);
  const auto coarse = load_organ(organ);
  const Vec3 touched(0.14, 0.04, 0.08);
  organ.solid.refine = {{SphereRegion{touched, 0.01}}, 5e-3, 0.5};
  for (const char* model : {"nodal_pressure", "quadratic_elements"}) {
    organ.model = model;
    const auto fine = load_organ(organ);
    INFO(model << ": " << fine.node_count() << " nodes");
    CHECK(fine.tetrahedra.size() > 2 * coarse.tetrahedra.size());
    double shortest = 1;
    for (const auto& t : fine.tetrahedra) {
      for (const auto& [a, b] : geometry::kTetrahedronEdges) {
        const Vec3 &p = fine.node(t[static_cast<std::size_t>(a)]),
                   &q = fine.node(t[static_cast<std::size_t>(b)]);
        const double away = std::max(0.0, ((p + q) / 2 - touched).norm() - 0.01);
        CHECK((p - q).norm() < 5e-3 + 0.5 * away + 1e-12);
        shortest = std::min(shortest, (p - q).norm());
      }
    }
    CHECK(shortest > 2e-3);  // a halving more than needed at most, of a longest edge
    CHECK(geometry::enclosed_volume(fine.surface.nodes, fine.surface.triangles) ==
          Approx(0.08 * 0.08 * 0.08));
  }
}

TEST_CASE("assets: near a box is on its faces' side, and too many nodes are refused by key") {
  // Oracle: the count of those of equal distance; the message.
  const ScratchFolder folder;
  Organ organ = block_organ(folder);
  organ.solid.refine = {{BoxRegion{Vec3(-1, -1, 0.07), Vec3(1, 1, 1)}}, 1e-2, 100};
  const auto fine = load_organ(organ);
  std::size_t above = 0, below = 0;
  for (std::size_t i = 0; i < fine.node_count(); ++i) {
    ++(fine.node(i).z() > 0.04 ? above : below);
  }
  CHECK(above > 3 * below);
  organ.solid.refine.edge_length = 2e-4;
  CHECK_THROWS_WITH(load_organ(organ), Catch::Contains("organ 'block': key 'solid.refine': ") &&
                                           Catch::Contains("more than 50000 nodes"));
}

TEST_CASE("assets: an organ is loaded and placed by its pose") {
  // Oracle: by hand; a quarter turn about z swaps the box's x and y extents.
  const ScratchFolder folder;
  Organ organ = box_organ(folder);
  organ.pose.position = Vec3(1, 2, 3);
  organ.pose.rotation = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ());
  const auto surface = load_organ(organ).surface;
  CHECK(surface.nodes.size() == 8);
  const auto [low, high] = extent(surface);
  CHECK((low - Vec3(0.97, 1.98, 2.96)).norm() < kFileRounding);
  CHECK((high - Vec3(1.03, 2.02, 3.04)).norm() < kFileRounding);
}

TEST_CASE("assets: a mesh in millimetres is a thousandth of the same in metres") {
  // Oracle: the definition of the unit.
  const ScratchFolder folder;
  Organ organ = box_organ(folder);
  organ.mesh.unit = "mm";
  const auto surface = load_organ(organ).surface;
  CHECK((extent(surface)[1] - Vec3(0.02, 0.03, 0.04) * 1e-3).norm() < kFileRounding * 1e-3);
}

TEST_CASE("assets: a probe's mesh stays in the probe's frame, other shapes have none") {
  // Oracle: the file's own numbers.
  const ScratchFolder folder;
  Probe probe;
  probe.shape = MeshShape{box_organ(folder).mesh};
  CHECK((extent(load_probe_mesh(probe))[1] - Vec3(0.02, 0.03, 0.04)).norm() < kFileRounding);
  for (const ProbeShape& shape :
       {ProbeShape(SphereShape{}), ProbeShape(CapsuleShape{}), ProbeShape(BoxShape{}),
        ProbeShape(ConeShape{}), ProbeShape(GrasperShape{}), ProbeShape(PlaneShape{})}) {
    probe.shape = shape;
    CHECK(load_probe_mesh(probe).nodes.empty());
  }
}

TEST_CASE("assets: what is wrong with a mesh is said of the organ or probe by name") {
  // Oracle: an open surface holds no volume; the message begins with the owner.
  const ScratchFolder folder;
  Organ organ = box_organ(folder);
  auto open = geometry::make_box(Vec3(0.04, 0.06, 0.08));
  open.triangles.pop_back();
  geometry::write_surface(open, organ.mesh.file);
  CHECK_THROWS_MATCHES(
      load_organ(organ), InputError, Catch::Predicate<InputError>([&](const InputError& error) {
        const std::string text = error.what();
        return text.starts_with("organ 'cube': ") && text.find("cube.off") != std::string::npos;
      }));
  Probe probe;
  probe.name = "tool";
  probe.shape = MeshShape{organ.mesh};
  CHECK_THROWS_MATCHES(load_probe_mesh(probe), InputError,
                       Catch::Predicate<InputError>([](const InputError& error) {
                         return std::string(error.what()).starts_with("probe 'tool': ");
                       }));
}
