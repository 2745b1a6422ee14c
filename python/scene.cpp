#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "modules/scene/scene_document.h"
#include "modules/scene/scene_reader.h"
#include "python/bindings.h"
#include "python/python_value.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

using scene::SceneDocument;

std::vector<SceneDocument::Change> changes_from(const py::dict& values) {
  std::vector<SceneDocument::Change> changes;
  for (const auto& [path, value] : values) {
    if (!py::isinstance<py::str>(path)) throw py::type_error("a key's path must be a str");
    changes.emplace_back(path.cast<std::string>(), scene_value(value));
  }
  return changes;
}

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& list) {
  std::vector<std::string> names;
  for (const Named& entry : list) names.push_back(entry.name);
  return names;
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<SceneDocument>(module, "Scene")
      .def_static("load", [](const std::string& file) { return SceneDocument(file); })
      .def_static("parse",
                  [](std::string text, const std::string& file) {
                    return SceneDocument(std::move(text), file);
                  })
      .def("change",
           [](SceneDocument& self, const py::dict& values) { self.change(changes_from(values)); })
      .def("value", [](const SceneDocument& self,
                       const std::string& path) { return python_value(self.value(path)); })
      .def("copy", [](const SceneDocument& self) { return SceneDocument(self); })
      .def("text", [](const SceneDocument& self) { return scene::resolved_text(self.scene()); })
      .def("digest", [](const SceneDocument& self) { return scene::scene_digest(self.scene()); })
      .def_property_readonly("file",
                             [](const SceneDocument& self) { return self.scene().file.string(); })
      .def_property_readonly("name", [](const SceneDocument& self) { return self.scene().name; })
      .def_property_readonly(
          "organs", [](const SceneDocument& self) { return names_of(self.scene().organs); })
      .def_property_readonly(
          "probes", [](const SceneDocument& self) { return names_of(self.scene().probes); });
}

}  // namespace palpate::python
