// What a scene holds, what it costs on this machine, and what is doubtful about it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "deformation/world.h"
#include "modules/core/types.h"
#include "modules/messages/messages.h"
#include "modules/scene/scene.h"
#include "palpate/scene_doubts.h"

namespace palpate::launcher {

struct OrganCheck {
  std::string name, model;
  Vec3 size = Vec3::Zero();     ///< of its box in W [m]
  double volume = 0, mass = 0;  ///< [m³], [kg]
  std::size_t surface_nodes = 0, inner_nodes = 0, fixed_nodes = 0, triangles = 0;
  std::size_t tetrahedra = 0;                                  ///< 0: springs
  bool quadratic = false;                                      ///< of tetrahedra
  double asked_poisson_ratio = 0, computed_poisson_ratio = 0;  ///< of a solid
  std::size_t structural = 0, bending = 0, inner = 0;          ///< springs of each family
  /// Of a model that takes both: chosen by the machine-independent rule or by the scene, and the
  /// passes over the springs per simulated second of either.
  std::optional<deformation::IntegratorChoice> integrator;
  bool integrator_automatic = false;
  double largest_step = 0;  ///< stable [s]
  int substeps = 0;         ///< in a period of deformation
};

struct ProbeCheck {
  std::string name;
  std::string shape, device;  ///< words of the scene
  ProbeMotion motion;
};

struct SceneCheck {
  scene::Scene scene;
  std::vector<OrganCheck> organs;
  std::vector<ProbeCheck> probes;
  std::vector<std::string> doubts;
  double period = 0;         ///< of deformation [s]
  double cost = 0;           ///< time of deformation in a period, lightly touched [s]
  double mesh_changes = 0;   ///< of the first organ while that was measured [1/s]
  ContactTroubles troubles;  ///< while that was measured

  double real_time_factor() const { return cost > period ? period / cost : 1; }
};

/// @param measure_for  about how long the cost of a period is measured [s]
/// @throws InputError for a scene, mesh or recording that cannot be used
SceneCheck check_scene(const scene::Scene& scene, double measure_for,
                       const trajectories::Progress& progress = {},
                       const scene::Resampling& resampling = {});

}  // namespace palpate::launcher
