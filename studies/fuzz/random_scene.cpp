#include "studies/fuzz/random_scene.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include "deformation/models.h"
#include "modules/scene/models.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/schema.h"
#include "studies/fuzz/random_probe.h"
#include "studies/fuzz/random_stream.h"

namespace palpate::fuzz {
namespace {

constexpr std::array<const char*, kFaultCount> kFaultNames{"pose_not_a_number",
                                                           "pose_infinite",
                                                           "pose_denormal",
                                                           "pose_huge",
                                                           "rotation_zero",
                                                           "gap_not_a_number",
                                                           "normal_nan",
                                                           "normal_denormal",
                                                           "point_infinite",
                                                           "point_huge",
                                                           "gap_huge",
                                                           "unknown_organ",
                                                           "unknown_triangle",
                                                           "unknown_probe",
                                                           "many_contacts",
                                                           "model_not_a_number",
                                                           "model_huge",
                                                           "device_not_a_number",
                                                           "lost",
                                                           "late",
                                                           "twice"};

/// All as likely, but for those that factorise large matrices.
std::string random_model(RandomStream& random) {
  std::vector<std::string> usual, rare;
  for (const scene::ModelFormat& format : scene::model_formats()) {
    (format.is_quadratic() ? rare : usual).emplace_back(format.word);
  }
  const auto& words = random.chance(0.03) ? rare : usual;
  return words[random.below(words.size())];
}

scene::Tissue random_tissue(RandomStream& random) {
  scene::Tissue tissue;
  tissue.youngs_modulus = random.log_uniform(1e2, 1e7);
  tissue.wall_thickness = random.log_uniform(1e-4, 0.05);
  tissue.density = random.log_uniform(100, 5000);
  tissue.damping_ratio = random.chance(0.2) ? 0 : random.uniform(0, 2);
  tissue.drag = random.chance(0.2) ? 0 : random.log_uniform(0.1, 100);
  return tissue;
}

scene::Springs random_springs(RandomStream& random) {
  scene::Springs springs;
  springs.bending_ratio = random.chance(0.2) ? 0 : random.log_uniform(1e-3, 10);
  springs.virtual_nodes = random.below(13);
  springs.inner_ratio = springs.virtual_nodes == 0 ? 0 : random.log_uniform(1e-3, 100);
  return springs;
}

scene::Filling random_filling(RandomStream& random) {
  scene::Filling filling;
  double time = 0;
  for (std::size_t i = random.below(4); i > 0; --i) {
    filling.points.push_back({time, random.log_uniform(0.2, 5)});
    time += random.log_uniform(1e-3, 0.2);
  }
  if (random.chance(0.3)) filling.breathing_amplitude = random.uniform(0, 0.5);
  filling.breathing_rate = random.log_uniform(0.01, 5);
  filling.max_rate = random.log_uniform(1e-3, 10);
  return filling;
}

PlacedShape random_shape(RandomStream& random, const std::string& model) {
  const double cost = deformation::row_of(model).step_cost;
  const bool tiny = cost >= 100, tiniest = cost >= 1000;
  PlacedShape placed;
  placed.shape = static_cast<Shape>(random.below(tiniest ? 1
                                                 : tiny  ? kTinyShapeCount
                                                         : kShapeCount));
  placed.size = Vec3::Constant(random.log_uniform(0.02, 0.3));
  if (random.chance(0.3)) placed.size[int(random.below(3))] *= random.log_uniform(0.05, 1);
  return placed;
}

scene::Region random_region(RandomStream& random, const Vec3& center, const Vec3& size) {
  const double x = random.uniform(-0.6, 0.6), y = random.uniform(-0.6, 0.6),
               z = random.uniform(-0.6, 0.6);
  const Vec3 place = center + size.cwiseProduct(Vec3(x, y, z));
  const double extent = size.maxCoeff() * random.log_uniform(0.1, 1);
  if (random.chance(0.5)) return scene::SphereRegion{place, extent / 2};
  return scene::BoxRegion{place.array() - extent / 2, place.array() + extent / 2};
}

/// What does not go with a model is asked for now and then, and refused.
bool asks(RandomStream& random, bool fits) { return random.chance(fits ? 0.5 : 0.02); }

scene::Organ random_organ(RandomStream& random, std::size_t index, PlacedShape& placed) {
  scene::Organ organ;
  organ.name = fmt::format("organ_{}", index);
  organ.model = random_model(random);
  placed = random_shape(random, organ.model);
  organ.mesh.file = fmt::format("{}_{}.ply", organ.name, name_of(placed.shape));
  const double apart = random.chance(0.1) ? 50 : 0.05 + 0.2 * static_cast<double>(index);
  organ.pose.position = apart * random.direction();
  if (random.chance(0.5)) organ.pose.rotation = random.rotation();
  organ.tissue = random_tissue(random);
  organ.springs = random_springs(random);
  const scene::ModelFormat& format = scene::format_of(organ.model);
  const double incompressible = format.is_solid() ? format.largest_poisson_ratio : 0.4999;
  organ.solid.poisson_ratio = random.chance(0.3) ? incompressible : random.uniform(0, 0.49);
  organ.solid.modes = 1 + random.below(20);
  organ.volume_corrections = random.chance(0.5) ? 0 : random.below(6);
  if (asks(random, format.has_integrator)) {
    organ.integrator = random.chance(0.5) ? scene::Integrator::kSymplecticEuler
                                          : scene::Integrator::kBackwardEuler;
  }
  if (asks(random, !format.is_solid())) organ.filling = random_filling(random);
  for (std::size_t i = random.below(3); i > 0; --i) {
    organ.fixed.push_back(random_region(random, organ.pose.position, placed.size));
  }
  return organ;
}

void set_limits(RandomStream& random, scene::Scene& scene) {
  if (random.chance(0.5)) scene.gravity = random.log_uniform(1, 100) * random.direction();
  scene.duration = random.uniform(0.1, 0.3);
  scene.rates.haptics = random.log_uniform(500, 4000);
  scene.rates.collision = random.log_uniform(10, 2000);
  scene.rates.deformation = random.log_uniform(10, 2000);
  if (random.chance(0.5)) scene.rates.collision = scene.rates.deformation;
  scene.haptics.max_force = random.log_uniform(0.1, 100);
  scene.haptics.max_force_rate = random.log_uniform(1, 1e5);
  scene.haptics.device_damping = random.uniform(0, 50);
  scene.haptics.stale_after = random.log_uniform(0.005, 1);
}

}  // namespace

const char* name_of(Fault fault) { return kFaultNames[static_cast<std::size_t>(fault)]; }

RandomScene random_scene(std::uint64_t seed, std::uint64_t number) {
  RandomStream random(seed, number);
  RandomScene made;
  made.scene.name = fmt::format("fuzz_{}_{}", seed, number);
  made.organ_shapes.resize(random.chance(0.8) ? 1 : 2);
  for (std::size_t i = 0; i < made.organ_shapes.size(); ++i) {
    made.scene.organs.push_back(random_organ(random, i, made.organ_shapes[i]));
  }
  set_limits(random, made.scene);
  add_probes(random, made);
  if (!random.chance(0.4)) return made;
  for (std::size_t i = 1 + random.below(4); i > 0; --i) {
    made.faults.push_back({static_cast<Fault>(random.below(kFaultCount)),
                           static_cast<std::uint32_t>(random.below(made.scene.probes.size())),
                           random.uniform(0, made.scene.duration)});
  }
  return made;
}

std::string text_of(const RandomScene& scene) {
  scene::Scene readable = scene.scene;  // a reader refuses what a model ignores
  for (scene::Organ& organ : readable.organs) scene::drop_ignored_keys(organ);
  std::string text = scene::resolved_text(readable);
  const auto size_text = [](const Vec3& v) { return fmt::format("{} {} {} m", v[0], v[1], v[2]); };
  for (const PlacedShape& placed : scene.organ_shapes) {
    text += fmt::format("# organ: {} of {}\n", name_of(placed.shape), size_text(placed.size));
  }
  for (const PlacedShape& placed : scene.probe_shapes) {
    text += fmt::format("# probe mesh: {} of {}\n", name_of(placed.shape), size_text(placed.size));
  }
  for (const TimedFault& timed : scene.faults) {
    text += fmt::format("# at {} s probe {}: {}\n", timed.time, timed.probe, name_of(timed.fault));
  }
  return text;
}

}  // namespace palpate::fuzz
