// Errors of the product as Python's exceptions.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>

namespace palpate::python {

void bind_errors(pybind11::module_& module);

/// How often a long call does.
inline constexpr std::chrono::milliseconds kLookForSignals{50};

/// Asks Python whether Ctrl-C was pressed; called without the GIL. @throws error_already_set if so
void look_for_signals();

}  // namespace palpate::python
