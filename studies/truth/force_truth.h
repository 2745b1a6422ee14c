// The force that an organ, a solid or a wall filled with fluid, exerts on rigid probes at rest,
// with an error bar: equilibria of quadratic elements on two nested meshes, extrapolated. It shares
// nothing with what it judges but the organ's shape, tissue and fixed part.
//   L. Richardson, "The deferred approach to the limit", Phil. Trans. R. Soc. A 226, 1927
#pragma once

#include <functional>
#include <vector>

#include "modules/core/parallel.h"
#include "modules/scene/scene.h"
#include "studies/truth/pressed_solid.h"

namespace palpate::truth {

/// The organ as a solid of its tissue, in W: its own surface, filled with tetrahedra as large as
/// the surface's triangles, or its own tetrahedra.
/// @throws InputError as scene::load_skin(), or if gmsh is missing
Body body_of(const scene::Organ& organ);

/// The organ as a wall of its tissue, incompressible, `wall_thickness` thick under its surface and
/// filled with incompressible fluid, in W.
/// @param thinned  if not null: nodes where it is thinner, see wall_under()
/// @throws InputError as scene::load_skin() and wall_under()
Body wall_of(const scene::Organ& organ, std::size_t* thinned = nullptr);

struct Question {
  Station free;                   ///< where the probes touch nothing
  std::vector<Station> stations;  ///< each reached from the one before, in straight lines
  std::vector<Vec3> marks;        ///< near the surface at rest [m]
};

struct Truth {
  std::vector<Vec3> forces;         ///< on the probes [N]
  std::vector<double> bars;         ///< of each force's size, which is that far off at most [N]
  std::vector<Vec3> displacements;  ///< at the marks [m]
  double displacement_bar = 0;      ///< RMS over the marks [m]
  std::size_t node_count = 0;       ///< of the finer mesh
};

struct Effort {
  ChunkRunner* runner = nullptr;  ///< of the finer mesh's equilibria; none: the calling thread
  /// Edges of all tetrahedra, over those usual: less than 1 for a truth that judges truths.
  double fineness = 1;
  std::function<void()> keep_going = [] {};  ///< asked often, by any thread of these; may throw
  /// Told what part of the way on the coarser mesh is done, which takes about half of the time.
  std::function<void(double part)> at = [](double) {};
};

/// One per station; fewer if from some load on no equilibrium is found: where the surface folds.
/// @throws InputError if a probe is so small that the mesh would be too large
std::vector<Truth> force_truth(const Body& body, const Question& question, const Effort& effort);

/// From answers of a mesh and of a finer one, edges 1/√2 as long. Errors c hᵖ have their limit at
/// fine + θ (fine − coarse), θ = 1/(√2ᵖ − 1); θ is taken as 2/3 ± 1, so p from 1.4 up is within the
/// bar, and some change that follows no order.
struct Extrapolated {
  Vec3 value = Vec3::Zero();
  double bar = 0;
};
Extrapolated extrapolated(const Vec3& coarse, const Vec3& fine);

/// As ChunkRunner::run(), of a task that may throw: what one threw is thrown at the end.
void run_all(ChunkRunner& runner, std::size_t count, const std::function<void(std::size_t)>& task);

}  // namespace palpate::truth
