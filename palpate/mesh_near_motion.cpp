#include "palpate/mesh_near_motion.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "modules/core/error.h"
#include "modules/geometry/organ_shape.h"
#include "modules/scene/assets.h"
#include "modules/scene/touched_places.h"
#include "modules/trajectories/pose_collector.h"
#include "modules/trajectories/trajectory_file.h"
#include "palpate/scene_doubts.h"

namespace palpate::geometry {
namespace {

constexpr double kStride = 0.25;  // radii, between places that are looked at
constexpr double kStill = 1e-3;   // no press or stroke is as short [m]

/// What is said of keys of a scene holds for options here.
std::string in_options(const std::string& text) {
  if (text.find("key") == std::string::npos) return text;
  return text + " (keys of a scene; here --near-columns T,X,Y,Z, --near-unit, --near-topic)";
}

/// As `launcher::doubt_about_extent`, with the option that mends it.
std::string doubt_about_unit(const NearMotion& motion, double extent) {
  const std::string doubt = launcher::doubt_about_extent(motion.file.string(), extent);
  if (!doubt.empty()) return doubt + " Then say --near-unit mm";
  if (extent == 0 || extent >= kStill || motion.unit == "m") return "";
  return fmt::format(
      "{} moves over {:.2g} mm in all, read in {}: are its positions in metres? Then "
      "leave out --near-unit",
      motion.file.string(), 1e3 * extent, motion.unit);
}

std::vector<trajectories::TimedPose> poses_of(const NearMotion& motion,
                                              std::vector<std::string>& notes) {
  scene::TrajectoryDevice device;
  device.file = motion.file;
  device.length_unit = motion.unit;
  device.columns = motion.columns;
  if (!motion.topic.empty()) device.topic = motion.topic;
  try {
    auto poses = trajectories::read_trajectory(device, notes);
    std::erase_if(notes, trajectories::is_of_steps);
    for (std::string& note : notes) note = in_options(note);
    return poses;
  } catch (const InputError& error) {
    throw InputError(in_options(error.what()));
  }
}

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
  const Pose place = place_of(motion);
  SphereWay way;
  Eigen::AlignedBox3d box;
  for (const auto& [time, pose] : poses_of(motion, way.notes)) {
    way.places.push_back(place.to_world(pose.position));
    box.extend(way.places.back());
  }
  const std::string doubt = doubt_about_unit(motion, box.diagonal().norm());
  if (!doubt.empty()) way.notes.push_back(doubt);
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
    throw InputError(fmt::format("--edge-m {:g}, --growth {:g}, {} nodes before: {}",
                                 *touched.refine.edge_length, *touched.refine.growth,
                                 mesh.nodes.size(), error.what()));
  }
  return touched;
}

}  // namespace palpate::geometry
