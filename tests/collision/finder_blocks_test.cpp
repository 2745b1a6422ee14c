#include <catch2/catch.hpp>

#include "modules/core/tolerances.h"
#include "tests/collision/finder_scene.h"

namespace palpate::collision {
namespace {

using BlocksOfTriangles = std::vector<std::vector<std::uint32_t>>;

bool same_contact(const Contact& a, const Contact& b) {
  return a.organ == b.organ && a.triangle == b.triangle && a.barycentric == b.barycentric &&
         a.point_P == b.point_P && a.normal_P == b.normal_P && a.gap == b.gap;
}

bool same_face(const FaceContacts& a, const FaceContacts& b) {
  return a.organ == b.organ && a.point_P == b.point_P && a.normal_P == b.normal_P &&
         a.gap == b.gap && a.node_count == b.node_count;
}

/// Two organs that swing, and a probe that comes, goes, turns, is pushed in and jumps.
struct SwingingScene {
  RandomShapes random;
  std::vector<geometry::TriangleSurface> organs;
  Pose pose;

  explicit SwingingScene(unsigned seed) : random(seed) {
    organs = {random.deformed_ball(0.05, 3), random.deformed_ball(0.03, 2)};
    for (Vec3& x : organs[1].nodes) x[0] += 0.09;
    pose = at(Vec3(0.08, 0.02, 0));
  }
  ProbeMotion step() {
    const Vec3 swing = random.point(5e-4), wave = 30 * random.direction();
    for (auto& organ : organs) {
      for (Vec3& x : organ.nodes)
        x = (x + std::sin(wave.dot(x)) * swing).cast<float>().cast<double>();
    }
    const Pose before = pose;
    const double choice = random.number(0, 1);
    if (choice < 0.02) pose = at(random.point(0.06), random.rotation());
    const Vec3 home = choice < 0.5 ? Vec3(0, 0, 0) : Vec3(0.06, 0.03, 0.01);
    pose.position += 0.08 * (home - pose.position) + random.point(0.003);
    pose.rotation =
        (Quat(Eigen::AngleAxisd(random.number(0, 0.05), random.direction())) * pose.rotation)
            .normalized();
    return {choice < 0.02 ? pose : before, pose};
  }
};

}  // namespace

TEST_CASE("contact finder: the same bits whatever the blocks, told or not, of every shape") {
  // Oracle: brute force; one block of all triangles, whose nodes are all looked at in each step.
  scene::MeshShape mesh;
  const std::vector<geometry::ProbeForm> forms{
      probe_of(scene::SphereShape{0.006}),
      probe_of(scene::CapsuleShape{0.003, 0.04}),
      probe_of(scene::CapsuleShape{3e-4, 0.1}),
      probe_of(scene::BoxShape{Vec3(0.02, 0.01, 0.03)}),
      probe_of(scene::ConeShape{0.004, 0.03}),
      probe_of(scene::GrasperShape{0.02, 0.005, 0.003, 0.6}),
      probe_of(scene::PlaneShape{}),
      scene::form_of(mesh, geometry::make_ball(0.01, 1))};
  std::size_t contacts = 0, face_nodes = 0, pushed = 0;
  for (std::size_t f = 0; f < forms.size(); ++f) {
    SwingingScene motion(static_cast<unsigned>(100 + f));
    const auto triangles = FinderScene::triangles_of(motion.organs);
    BlocksOfTriangles whole, small;
    std::vector<geometry::SurfaceBlocks> told;
    for (const auto& organ : motion.organs) {
      whole.emplace_back(organ.triangles.size(), 0);
      small.push_back(geometry::SurfaceBlocks::split(organ.nodes, organ.triangles, 16));
      told.emplace_back(organ.triangles, small.back());
    }
    ContactFinder brute(triangles, {forms[f]}, whole), by_blocks(triangles, {forms[f]}, small),
        own(triangles, {forms[f]});
    std::array<std::vector<float>, 2> floats;
    std::array<std::vector<geometry::BlockBox>, 2> boxes;
    for (int k = 0; k < 150; ++k) {
      const ProbeMotion way = motion.step();
      for (std::size_t i = 0; i < motion.organs.size(); ++i) {
        const auto& nodes = motion.organs[i].nodes;
        brute.update_organ(i, nodes);
        own.update_organ(i, nodes);
        floats[i].clear();
        for (const Vec3& x : nodes) {
          for (int axis = 0; axis < 3; ++axis) floats[i].push_back(static_cast<float>(x[axis]));
        }
        told[i].bound(floats[i], boxes[i]);
        by_blocks.take_organ(i, floats[i], boxes[i]);
      }
      std::array<ContactSet, 3> found;
      std::array<SearchReport, 3> reports;
      const std::array<ContactFinder*, 3> finders{&brute, &by_blocks, &own};
      for (std::size_t i = 0; i < 3; ++i) {
        reports[i] = finders[i]->find(0, way, 0.002, kMost, found[i]);
      }
      for (std::size_t i = 1; i < 3; ++i) {
        CHECK(reports[i].begun_inside == reports[0].begun_inside);
        CHECK(reports[i].was_lost == reports[0].was_lost);
        CHECK(std::equal(found[0].contacts.begin(), found[0].contacts.end(),
                         found[i].contacts.begin(), found[i].contacts.end(), same_contact));
        CHECK(std::equal(found[0].faces.begin(), found[0].faces.end(), found[i].faces.begin(),
                         found[i].faces.end(), same_face));
        CHECK(found[i].face_nodes == found[0].face_nodes);
        CHECK(found[i].truncated == found[0].truncated);
      }
      contacts += found[0].contacts.size();
      face_nodes += found[0].face_nodes.size();
      pushed += !found[0].contacts.empty() && deepest_gap(found[0]) < -0.002;
    }
  }
  CHECK(contacts > 5000);
  CHECK(face_nodes > 5000);
  CHECK(pushed > 100);
}

}  // namespace palpate::collision
