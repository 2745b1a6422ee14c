// palpate._core, what the package's Python stands on.
#include "python/bindings.h"
#include "python/errors.h"
#include "python/unlocked.h"

PYBIND11_MODULE(_core, module) {
  using namespace palpate::python;
  module.attr("__version__") = PALPATE_VERSION;
  bind_errors(module);
  bind_scene(module);
  bind_session(module);
  bind_live(module);
  bind_recording(module);
  bind_mesh(module);
  module.def("end_work", &end_unlocked_work);
}
