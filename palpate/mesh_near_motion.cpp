#include "palpate/mesh_near_motion.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "modules/core/error.h"
#include "modules/geometry/organ_shape.h"
#include "modules/scene/assets.h"
#include "modules/scene/touched_places.h"
#include "modules/trajectories/trajectory_file.h"
#include "palpate/scene_doubts.h"

namespace palpate::geometry {
namespace {

constexpr double kStride = 0.25;  // radii, between places that are looked at

Pose place_of(const NearMotion& motion) {
  constexpr double kUnit = 1e-3;
  Pose place;
  if (!motion.position.empty()) {
    if (motion.position.size() != 3) throw InputError("--near-position-m must be x, y, z");
    place.position = Eigen::Map<const Vec3>(motion.position.data());
  }
  if (!motion.rotation.empty()) {
    const Eigen::Map<const Eigen::VectorXd> xyzw(motion.rotation.data(),
                                                 static_cast<Eigen::Index>(motion.rotation.size()));
    if (xyzw.size() != 4 || std::abs(xyzw.norm() - 1) > kUnit) {
      throw InputError("--near-rotation-xyzw must be a unit quaternion x, y, z, w");
    }
    place.rotation = Quat(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized();
  }
  return place;
}

/// Calls `look` with places a stride apart at most, and no nearer while the sphere stays about;
/// where it cannot touch none.
template <class Look>
void walk(const SphereWay& way, const Eigen::AlignedBox3d& reach, double stride, const Look& look) {
  Vec3 from = way.places.front();
  look(from);
  for (const Vec3& to : way.places) {
    const double distance = (to - from).norm();
    if (distance < stride) continue;
    Eigen::AlignedBox3d passed(from);
    const auto parts = std::llround(std::ceil(distance / stride));
    for (long long k = 1; passed.extend(to).intersects(reach) && k <= parts; ++k) {
      look(Vec3(from + (to - from) * double(k) / double(parts)));
    }
    from = to;
  }
}

InputError untouched(const NearMotion& motion, const SphereWay& way, const TriangleSurface& skin) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& x : way.places) {
    for (const Vec3& node : skin.nodes) nearest = std::min(nearest, (node - x).norm());
  }
  return InputError(fmt::format(
      "{}: a sphere of {:g} mm touches nothing on its way, read in {}; it comes no nearer than "
      "{:.3g} mm to a node. Are --near-unit and its place in the mesh's frame (--near-position-m, "
      "--near-rotation-xyzw) right?",
      motion.file.string(), 1e3 * *motion.radius, motion.unit, 1e3 * nearest));
}

}  // namespace

SphereWay read_way(const NearMotion& motion) {
  scene::TrajectoryDevice device;
  device.file = motion.file;
  device.length_unit = motion.unit;
  device.columns = motion.columns;
  const Pose place = place_of(motion);
  SphereWay way;
  Eigen::AlignedBox3d box;
  for (const auto& [time, pose] : trajectories::read_trajectory(device, way.notes)) {
    way.places.push_back(place.to_world(pose.position));
    box.extend(way.places.back());
  }
  const std::string doubt =
      launcher::doubt_about_extent(motion.file.string(), box.diagonal().norm());
  if (!doubt.empty()) way.notes.push_back(doubt + " Then say --near-unit mm");
  return way;
}

TouchedMesh refined_near(const TetMesh& mesh, const NearMotion& motion, const SphereWay& way) {
  const TriangleSurface skin = shape_of(mesh).surface;
  const double radius = *motion.radius;
  Eigen::AlignedBox3d reach;
  for (const Vec3& node : skin.nodes) reach.extend(node);
  reach.min().array() -= radius;
  reach.max().array() += radius;
  std::vector<scene::SphereRegion> balls;
  walk(way, reach, kStride * radius, [&](const Vec3& x) {
    if (reach.contains(x)) scene::add_touched(skin, {x, x, radius}, balls);
  });
  if (balls.empty()) throw untouched(motion, way, skin);
  TouchedMesh touched;
  touched.refine.near = {balls.begin(), balls.end()};
  touched.refine.edge_length = motion.edge.value_or(radius / 2);
  touched.refine.growth = motion.growth.value_or(scene::Refinement::kGrowth);
  try {
    touched.mesh = scene::refined(mesh, touched.refine, {});
  } catch (const InputError& error) {
    throw InputError(std::string("--edge-m, --growth: ") + error.what());
  }
  return touched;
}

}  // namespace palpate::geometry
