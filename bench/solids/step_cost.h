// What a step of an implicit solid costs, and its parts.
#pragma once

#include "modules/geometry/tet_mesh.h"
#include "modules/scene/scene.h"

namespace palpate::solids_bench {

/// Prints milliseconds per step of 10 ms of an organ that sways under gravity, a tenth of it fixed;
/// and, alternating with it, of its linearisation, of one product with its matrix, and of the
/// yardstick: the same product by a plain loop over the tetrahedra in double.
void print_step_cost(const std::string& model, const geometry::TetMesh& mesh);

}  // namespace palpate::solids_bench
