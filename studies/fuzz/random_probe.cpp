#include "studies/fuzz/random_probe.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "modules/core/rotation_vector.h"

namespace palpate::fuzz {
namespace {

constexpr double kPeakOfMean = 1.875;  // speeds of a minimum-jerk move

scene::ScriptedDevice::Move move_to(RandomStream& random, const Vec3& from, const Vec3& to) {
  const double speed = random.log_uniform(0.01, 5);
  const double duration = kPeakOfMean * (to - from).norm() / speed;
  return {to, random.chance(0.15) ? 1e-3 : std::clamp(duration, 1e-3, 3600.0)};  // or a jump
}

scene::ScriptedDevice random_way(RandomStream& random, const Vec3& center, double size) {
  scene::ScriptedDevice way;
  const double far = random.chance(0.1) ? 0.1 : random.uniform(0.5, 1.2);  // or begins inside
  way.start = center + size * far * random.direction();
  if (random.chance(0.7)) way.rotation = random.rotation();
  Vec3 at = way.start;
  for (std::size_t i = 1 + random.below(4); i > 0; --i) {
    if (random.chance(0.2)) {
      way.moves.push_back({std::nullopt, random.log_uniform(1e-3, 0.1)});
      continue;
    }
    const Vec3 to = center + size * random.uniform(0, 0.8) * random.direction();
    way.moves.push_back(move_to(random, at, to));
    at = to;
  }
  return way;
}

/// A device in a hand that follows `way`, or pushes towards the organ's middle.
scene::EmulatedDevice held(RandomStream& random, const scene::ScriptedDevice& way,
                           const Vec3& center) {
  using Kind = scene::EmulatedDevice::Kind;
  scene::EmulatedDevice device;
  device.kind = random.chance(0.5) ? Kind::kTouch : Kind::kOmega;
  device.start = way.start;
  device.rotation = way.rotation;
  device.rate = random.log_uniform(500, 4000);
  if (random.chance(0.5)) device.transport_delay = random.uniform(0, 5e-3);
  device.hand.mass = random.chance(0.5) ? 0 : random.uniform(0.05, 0.5);
  if (random.chance(0.5)) {
    device.hand.damping = random.log_uniform(0.5, 20);
    device.hand.stiffness = random.log_uniform(10, 2000);
    device.hand.moves = way.moves;
  } else {
    device.hand.push = random.log_uniform(0.05, 5) * (center - way.start).normalized();
  }
  return device;
}

/// Two plates meet in the organ's middle, but for a small gap.
void add_plates(RandomStream& random, const Vec3& center, double size, RandomScene& scene) {
  const Vec3 axis = random.direction();
  const double time = scene.scene.duration * random.uniform(0.3, 1);
  const double thickness = 0.05 * size;
  for (const double side : {1.0, -1.0}) {
    scene::ScriptedDevice way;
    way.rotation = rotation_between(Vec3::UnitZ(), axis);
    way.start = center + side * 0.7 * size * axis;
    way.moves.push_back({center + side * (thickness / 2 + 0.01 * size) * axis, time});
    scene.scene.probes.push_back(
        {"", scene::BoxShape{Vec3(3 * size, 3 * size, thickness)}, 0.1, way});
  }
}

}  // namespace

void add_probes(RandomStream& random, RandomScene& scene) {
  const Vec3 center = scene.scene.organs[0].pose.position;
  const double size = scene.organ_shapes[0].size.maxCoeff();
  auto& probes = scene.scene.probes;
  if (random.chance(0.1)) add_plates(random, center, size, scene);
  for (std::size_t i = probes.empty() ? 1 + random.below(3) : random.below(2); i > 0; --i) {
    const auto shape = scene::random_shape(random, size);
    const auto way = random_way(random, center, size);
    probes.push_back({"", shape, 0.1, way});
    if (random.chance(0.15)) probes.back().device = held(random, way, center);
  }
  for (std::size_t i = 0; i < probes.size(); ++i) {
    probes[i].name = fmt::format("probe_{}", i);
    probes[i].friction = random.chance(0.2) ? 0 : random.uniform(0, 2);
    PlacedShape mesh{static_cast<Shape>(random.below(kShapeCount)),
                     Vec3::Constant(size * random.log_uniform(0.05, 0.5))};
    if (scene::Mesh* named = mesh_of(probes[i].shape)) {
      named->file = fmt::format("probe_{}_{}.ply", i, name_of(mesh.shape));
    }
    scene.probe_shapes.push_back(mesh);
  }
}

}  // namespace palpate::fuzz
