// The model hierarchy, and how finely each model is used: its fidelity.
#pragma once

#include <string>
#include <vector>

#include "modules/geometry/organ_shape.h"
#include "modules/scene/scene.h"

namespace palpate::chart {

/// Where a solid's tetrahedra are smaller than elsewhere.
enum class Small {
  kNowhere,
  kAtPlaces,  ///< where it will be touched, in advance
  kFollowing  ///< where it is touched, as probes go
};

/// "", "near" or "follow": the scene's keys.
const char* word_of(Small small);

/// A model at one mesh size and step: one point of a chart.
struct Setting {
  std::string model = "implicit_volume";
  int level = 1;               ///< of the mesh, 0 coarse; each level halves the edges
  double rate = 250;           ///< steps asked for per simulated second [Hz]; a model may sub-step
  std::size_t iterations = 0;  ///< scene key of this name; 0: as many as the model has
  Small small = Small::kNowhere;  ///< then the level is that of these tetrahedra
  int places = 0;                 ///< of an organ pressed at many, the first so many; 0: at all

  std::string name() const;  ///< "corotational, level 1, 250 Hz, 10 iterations"
  std::string key() const;   ///< the same for file names: "corotational-1-250-10"
};

/// Of a sphere's radius.
struct SmallTetrahedra {
  double edge = 0;     ///< longest under it
  double growth = 0;   ///< per distance, in lengths
  double plateau = 0;  ///< from the touched place up to which edges do not grow
};
inline constexpr int kSmallLevels = 2;  ///< below which is a setting's level, where any are small
SmallTetrahedra small_tetrahedra(const Setting& setting);

/// The models of the chart, plain springs first, the most accurate last.
std::vector<std::string> model_hierarchy();

/// Linear tetrahedra without averaged pressures lock near ½: at most 0.45 for them, else as wanted.
double unlocked_poisson_ratio(const std::string& model, double wanted);

/// A filled solid of `radius` (of the ball of equal volume) as a scene would have it, with the
/// springs calibrated for solids (docs/calibration.md) where the model has springs.
/// @param virtual_nodes  1 for what has no dominant axis
scene::Organ solid_organ(const Setting& setting, double radius, std::size_t virtual_nodes,
                         double youngs_modulus, double density);

/// The mesh as the model wants it: its surface alone, linear, or with nodes on its edges.
geometry::OrganShape shape_for(const Setting& setting, const geometry::OrganShape& linear);

}  // namespace palpate::chart
