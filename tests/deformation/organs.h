// Organs and plates the deformation tests share.
#pragma once

#include <string>

#include "deformation/model/organ_model.h"
#include "deformation/steppers/symplectic_euler.h"
#include "deformation/volume/implicit_volume.h"
#include "deformation/world.h"
#include "modules/geometry/primitives.h"
#include "studies/rigs/squeezed_ball.h"
#include "tests/deformation/plate_contacts.h"

namespace palpate::deformation::testing {

using rigs::ball_organ;
using rigs::kBallRadius;

inline constexpr double kPeriod = 4e-3;  ///< of an advance [s]

inline OrganModel ball_model(int levels, const scene::Organ& organ = ball_organ(),
                             const Vec3& gravity = Vec3::Zero()) {
  return build_organ_model(organ, gravity, geometry::make_ball(kBallRadius, levels));
}

/// Symplectic Euler with the implicit volume constraint.
inline SymplecticEuler constrained(const OrganModel& model, int corrections = 0) {
  return {model, std::make_unique<ImplicitVolume>(model, corrections)};
}

/// Symplectic Euler of the springs alone.
inline SymplecticEuler springs_alone(const OrganModel& model) {
  return {model, std::make_unique<NoVolume>(model)};
}

/// Of all nodes [kg·m/s].
inline Vec3 momentum(const OrganModel& model, const OrganState& state) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    sum += model.masses[i] * state.velocities[i];
  }
  return sum;
}

inline scene::Scene ball_scene(std::size_t probes, const scene::Organ& organ = ball_organ()) {
  scene::Scene scene;
  scene.organs.push_back(organ);
  for (std::size_t i = 0; i < probes; ++i) {
    scene.probes.push_back(
        {"plate" + std::to_string(i), scene::PlaneShape{}, 0.0, scene::ScriptedDevice{}});
  }
  return scene;
}

}  // namespace palpate::deformation::testing
