#include "modules/scene/assets.h"

#include <numbers>

#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
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

}  // namespace

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
  for (const ProbeShape& shape : {ProbeShape(SphereShape{}), ProbeShape(CapsuleShape{}),
                                  ProbeShape(BoxShape{}), ProbeShape(PlaneShape{})}) {
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
