
#include "bench/solids/step_cost.h"
#include "modules/core/error.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/runtime/program.h"

int main(int argc, char** argv) {
  using namespace palpate;
  runtime::Program program("What a step of implicit solids costs, by its parts.",
                           "palpate-bench-solids");
  std::string mesh;
  program.add("MESH", mesh, "Mesh of tetrahedra, as a scene names it").required();
  return program.run(argc, argv, [&] {
    const auto tetrahedra = geometry::read_tetrahedra(mesh);
    for (const auto model : {"corotational", "nodal_pressure"}) {
      solids_bench::print_step_cost(model, tetrahedra);
    }
    return kExitDone;
  });
}
