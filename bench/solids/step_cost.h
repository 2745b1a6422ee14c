// What a step of an implicit solid costs, and its parts.
#pragma once

#include <string>

#include "modules/geometry/tet_mesh.h"

namespace palpate::solids_bench {

/// Prints milliseconds per step of 10 ms of an organ that sways under gravity, a tenth of it fixed;
/// of its linearisation and of one product with its matrix, by the plain code of the elements and
/// by their kernel, which take turns; with two threads; with 25 iterations and with as many as
/// steps need to a residual of 1e-2 in the mean; and what it costs to build the organ.
void print_step_cost(const std::string& model, const geometry::TetMesh& mesh);

}  // namespace palpate::solids_bench
