#include "python/python_value.h"

#include <limits>

namespace py = pybind11;

namespace palpate::python {
namespace {

constexpr int kDeepest = 16;  ///< no scene nests deeper; a list that holds itself does

scene::SceneValue value_from(py::handle object, int depth);

scene::SceneValue list_from(py::handle object, int depth) {
  scene::SceneValue::List list;
  for (const py::handle entry : object) list.push_back(value_from(entry, depth + 1));
  return {std::move(list)};
}

scene::SceneValue map_from(const py::dict& dict, int depth) {
  scene::SceneValue::Map map;
  for (const auto& [key, value] : dict) {
    if (!py::isinstance<py::str>(key)) throw py::type_error("a key of a scene must be a str");
    map.emplace_back(key.cast<std::string>(), value_from(value, depth + 1));
  }
  return {std::move(map)};
}

scene::SceneValue whole_from(py::handle object) {
  const py::int_ whole = py::reinterpret_borrow<py::object>(object);
  int overflow = 0;
  const long long value = PyLong_AsLongLongAndOverflow(whole.ptr(), &overflow);
  if (PyErr_Occurred() != nullptr) throw py::error_already_set();
  if (overflow != 0) return {overflow * std::numeric_limits<double>::infinity()};
  return {static_cast<std::int64_t>(value)};
}

scene::SceneValue value_from(py::handle object, int depth) {
  if (depth > kDeepest) throw py::type_error("a value of a scene cannot be nested that deep");
  if (object.is_none()) return {};
  if (py::isinstance<py::bool_>(object)) return {object.cast<bool>()};
  if (py::isinstance<py::int_>(object)) return whole_from(object);
  if (py::isinstance<py::float_>(object)) return {object.cast<double>()};
  if (py::isinstance<py::str>(object)) return {object.cast<std::string>()};
  if (py::isinstance<py::dict>(object)) {
    return map_from(py::reinterpret_borrow<py::dict>(object), depth);
  }
  if (py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object)) {
    return list_from(object, depth);
  }
  if (py::hasattr(object, "__fspath__")) {
    return {object.attr("__fspath__")().cast<std::string>()};
  }
  if (py::hasattr(object, "tolist")) return value_from(object.attr("tolist")(), depth + 1);
  throw py::type_error(
      "a value of a scene must be a bool, int, float, str, list, dict or None, not " +
      std::string(py::str(py::type::handle_of(object).attr("__name__"))));
}

struct Converter {
  py::object operator()(std::monostate) const { return py::none(); }
  py::object operator()(bool flag) const { return py::bool_(flag); }
  py::object operator()(std::int64_t whole) const { return py::int_(whole); }
  py::object operator()(double number) const { return py::float_(number); }
  py::object operator()(const std::string& text) const { return py::str(text); }
  py::object operator()(const scene::SceneValue::List& list) const {
    py::list result;
    for (const auto& entry : list) result.append(python_value(entry));
    return result;
  }
  py::object operator()(const scene::SceneValue::Map& map) const {
    py::dict result;
    for (const auto& [key, value] : map) result[py::str(key)] = python_value(value);
    return result;
  }
};

}  // namespace

scene::SceneValue scene_value(py::handle object) { return value_from(object, 0); }

py::object python_value(const scene::SceneValue& value) {
  return std::visit(Converter(), value.content);
}

}  // namespace palpate::python
