#include "python/numbers.h"

#include <cmath>
#include <sstream>

#include "modules/core/tolerances.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

std::string shape_text(const py::array& array) { return py::str(array.attr("shape")); }

void check_shape(const py::array& array, py::ssize_t numbers, const char* name) {
  if (array.ndim() == 1 && array.shape(0) == numbers) return;
  throw py::value_error(std::string(name) + " must have shape (" + std::to_string(numbers) +
                        ",), not " + shape_text(array));
}

}  // namespace

DoubleArray doubles_from(py::handle object, const char* name) {
  const py::array any = py::array::ensure(object);
  // Texts and objects would be asked to become numbers; complex ones would lose a part.
  if (!any || std::string("buif").find(any.dtype().kind()) == std::string::npos) {
    PyErr_Clear();
    throw py::type_error(std::string(name) + " must be numbers");
  }
  const DoubleArray array = DoubleArray::ensure(any);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(std::string(name) + " must be numbers");
  }
  const double* numbers = array.data();
  for (py::ssize_t i = 0; i < array.size(); ++i) {
    if (!std::isfinite(numbers[i])) throw py::value_error(std::string(name) + " must be finite");
  }
  return array;
}

Vec3 vector_from(py::handle object, const char* name, double most) {
  const DoubleArray array = doubles_from(object, name);
  check_shape(array, 3, name);
  const Vec3 vector(array.data()[0], array.data()[1], array.data()[2]);
  if (vector.cwiseAbs().maxCoeff() > most) {
    std::ostringstream said;
    said << name << ": each number must be between " << -most << " and " << most;
    throw py::value_error(said.str());
  }
  return vector;
}

Quat rotation_from(py::handle object, const char* name) {
  const DoubleArray array = doubles_from(object, name);
  check_shape(array, 4, name);
  const double* x = array.data();
  const Quat rotation(x[3], x[0], x[1], x[2]);
  if (!(std::abs(rotation.norm() - 1) <= kWrittenUnitTolerance)) {
    throw py::value_error(std::string(name) + " must be a unit quaternion x, y, z, w");
  }
  return rotation.normalized();
}

}  // namespace palpate::python
