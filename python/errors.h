// Errors of the product as Python's exceptions.
#pragma once

#include <pybind11/pybind11.h>

namespace palpate::python {

void bind_errors(pybind11::module_& module);

}  // namespace palpate::python
