// Vectors and arrays from whatever Python gives, checked.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "modules/core/types.h"

namespace palpate::python {

using DoubleArray =
    pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// An array of doubles. @param name  in messages
/// @throws type_error for what is none, value_error for numbers that are not finite
DoubleArray doubles_from(pybind11::handle object, const char* name);

/// @throws value_error, too, for another shape than (3,) or a number beyond ±`most`
Vec3 vector_from(pybind11::handle object, const char* name, double most);

/// x, y, z, w. @throws value_error, too, for another shape than (4,) or a length not 1 within 0.001
Quat rotation_from(pybind11::handle object, const char* name);

}  // namespace palpate::python
