// The ways to run a scene among which `palpate plan` chooses.
#pragma once

#include <string>
#include <vector>

#include "modules/scene/scene.h"

namespace palpate::plan {

/// One way to run the scene.
struct Candidate {
  std::string model = "implicit_volume";
  std::size_t nodes = 0;  ///< of the surface mesh, as the scene's key `nodes`
  double rate = 0;        ///< of deformation [Hz]
  scene::Integrator integrator = scene::Integrator::kAutomatic;
  scene::Refinement refine = {};  ///< of a solid's tetrahedra

  std::string name() const;
};

/// Where the reference of a wall filled with fluid comes from: springs and the implicit volume on
/// four times the nodes in small steps.
Candidate reference_of(const scene::Scene& scene);

/// All that are tried, on a quarter, half, once and twice the scene's nodes, at the least rate and
/// twice that; of a solid also with small tetrahedra at the places that probes touch, in advance or
/// wherever they are.
/// @param touched  those places; none: no such candidates
/// @param radius   of the smallest probe [m]
std::vector<Candidate> candidates_of(const scene::Scene& scene,
                                     const std::vector<scene::Region>& touched = {},
                                     double radius = 0);

/// About what a course of the candidate takes, in any unit: fitted to liver_solid.
/// @param radius  of the smallest probe [m]
double weight_of(const Candidate& candidate, double radius);

/// The scene as the candidate would run one of its organs.
scene::Scene scene_with(const scene::Scene& scene, const Candidate& candidate,
                        std::size_t organ = 0);

}  // namespace palpate::plan
