// The parts of the module, each in a file of its own.
#pragma once

#include <pybind11/pybind11.h>

namespace palpate::python {

void bind_scene(pybind11::module_& module);
void bind_session(pybind11::module_& module);
void bind_live(pybind11::module_& module);
void bind_recording(pybind11::module_& module);
void bind_mesh(pybind11::module_& module);

}  // namespace palpate::python
