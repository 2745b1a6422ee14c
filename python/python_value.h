// Values of a scene as Python's own: None, bool, int, float, str, list, dict.
#pragma once

#include <pybind11/pybind11.h>

#include "modules/scene/scene_value.h"

namespace palpate::python {

/// NumPy's numbers and arrays count as Python's. @throws type_error for what a scene cannot hold
scene::SceneValue scene_value(pybind11::handle object);
pybind11::object python_value(const scene::SceneValue& value);

}  // namespace palpate::python
