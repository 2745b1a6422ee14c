#include "modules/geometry/aabb_tree.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/mesh_prepare.h"
#include "scenes/meshes/organ_shapes.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;

namespace {

std::filesystem::path shipped(const std::string& name) {
  return std::filesystem::path(PALPATE_SOURCE_DIR) / "scenes/meshes" / name;
}

/// Loads as a scene does and checks what every shipped mesh promises.
MeshReport check_shipped(const std::string& name, std::size_t nodes) {
  INFO(name);
  TriangleSurface surface = read_surface(shipped(name), "m");
  CHECK(repair_surface(surface).actions.empty());
  const MeshReport report = check_surface(surface);
  CHECK(report.node_count == nodes);
  CHECK(report.triangle_count == 2 * nodes - 4);
  CHECK(report.holds_volume());
  CHECK(report.genus == 0);
  CHECK(report.longest_edge / report.shortest_edge < 3);
  CHECK(report.worst_aspect < 2.5);
  CHECK((report.min_corner + report.max_corner).norm() / 2 < 0.03);  // about the origin
  return report;
}

}  // namespace

TEST_CASE("shipped meshes: counts, closedness, evenness and human size") {
  // Oracle: the counts of the README, Euler's formula, anatomical sizes.
  CHECK(check_shipped("ball.ply", 642).volume == Approx(519.1e-6).epsilon(1e-3));
  const MeshReport stomach = check_shipped("stomach.ply", 550);
  CHECK(stomach.triangle_count == 1096);
  CHECK(stomach.volume > 250e-6);
  CHECK(stomach.volume < 400e-6);
  CHECK((stomach.max_corner - stomach.min_corner).norm() > 0.18);
  CHECK((stomach.max_corner - stomach.min_corner).norm() < 0.30);
  const MeshReport liver = check_shipped("liver.ply", 544);
  CHECK(liver.triangle_count == 1084);
  CHECK(liver.volume > 1.3e-3);
  CHECK(liver.volume < 1.8e-3);
  const MeshReport refined = check_shipped("stomach_refined.ply", 19'362);
  CHECK(refined.triangle_count >= 38'000);
  CHECK(refined.volume == Approx(stomach.volume).epsilon(0.01));
}

TEST_CASE("shipped meshes: the coarse stomach lies near the refined one's surface") {
  // Oracle: geometry: a chord of length L on radius r sags by L²/8r: 10 mm on 9 mm is 1.4 mm, and
  // the volume scaling moves nodes by less than 1 mm more.
  const TriangleSurface coarse = read_surface(shipped("stomach.ply"), "m");
  const AabbTree refined(read_surface(shipped("stomach_refined.ply"), "m"));
  double worst = 0;
  for (const Vec3& node : coarse.nodes) {
    worst = std::max(worst, std::sqrt(refined.nearest(node).squared_distance));
  }
  CHECK(worst < 2.4e-3);
}

TEST_CASE("shipped meshes: the generator makes the small ones again, byte for byte") {
  // Oracle: the committed files.
  const ScratchFolder folder;
  for (const auto& [file_name, make] : meshes::kShippedMeshes) {
    if (std::string(file_name) == "stomach_refined.ply") continue;  // takes many seconds
    INFO(file_name);
    write_surface(make(), folder / file_name);
    const TriangleSurface made = read_surface(folder / file_name, "m");
    const TriangleSurface stored = read_surface(shipped(file_name), "m");
    CHECK(made.triangles == stored.triangles);
    CHECK(text_in(folder / file_name) == text_in(shipped(file_name)));
  }
}

TEST_CASE("organ shapes: the patient's left is +x") {
  // Oracle: anatomy: the fundus and the left lobe are on the left, the pylorus on the right.
  CHECK(meshes::stomach_shape({0.036, 0.010, 0.045}) < 0);  // fundus
  CHECK(meshes::stomach_shape({-0.036, 0.010, 0.045}) > 0);
  CHECK(meshes::stomach_shape({-0.060, 0.003, -0.030}) < 0);  // pylorus
  CHECK(meshes::liver_shape({-0.070, 0.000, 0.000}) < 0);     // right lobe
  CHECK(meshes::liver_shape({0.070, -0.017, 0.032}) < 0);     // left lobe
  CHECK(meshes::liver_shape({0.070, 0.000, -0.050}) > 0);     // under the left lobe
}
