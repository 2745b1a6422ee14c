// The model hierarchy, and how finely each model is used: its fidelity.
#pragma once

#include <string>
#include <vector>

#include "modules/geometry/organ_shape.h"
#include "modules/scene/scene.h"

namespace palpate::chart {

/// A model at one mesh size and step: one point of a chart.
struct Setting {
  std::string model = "implicit_volume";
  int level = 1;               ///< of the mesh, 0 coarse; each level halves the edges
  double rate = 250;           ///< steps asked for per simulated second [Hz]; a model may sub-step
  std::size_t iterations = 0;  ///< scene key of this name; 0: as many as the model has

  std::string name() const;  ///< "corotational, level 1, 250 Hz, 10 iterations"
  std::string key() const;   ///< the same for file names: "corotational-1-250-10"
};

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
