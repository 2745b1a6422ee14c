#include "python/errors.h"

#include "modules/core/error.h"
#include "modules/scene/scene_error.h"
#include "python/busy.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

/// Raises an exception of palpate.errors, where they are written down with their fields.
template <class... Arguments>
void raise(const char* name, const Arguments&... arguments) {
  const py::object type = py::module_::import("palpate.errors").attr(name);
  PyErr_SetObject(type.ptr(), type(arguments...).ptr());
}

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const scene::SceneError& error) {
    raise("SceneError", error.what(), error.file, error.line, error.key);
  } catch (const InputError& error) {
    raise("InputError", error.what());
  } catch (const ClosedError& error) {
    raise("ClosedError", error.what());
  } catch (const Interrupted&) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
  } catch (const BusyError& error) {
    raise("BusyError", error.what());
  }
}

}  // namespace

void bind_errors(py::module_&) { py::register_exception_translator(&translate); }

}  // namespace palpate::python
