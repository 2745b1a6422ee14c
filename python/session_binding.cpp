#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>

#include "modules/core/error.h"
#include "modules/scene/scene_document.h"
#include "python/bindings.h"
#include "python/numbers.h"
#include "python/session.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

constexpr double kFurthest = 100;  ///< as any point of a scene [m]
constexpr double kFastest = 100;   ///< no instrument is [m/s, rad/s]

void guide_probe(Session& session, std::size_t probe, py::handle position, py::handle rotation,
                 py::handle linear, py::handle angular) {
  const Pose pose{vector_from(position, "position_m", kFurthest),
                  rotation_from(rotation, "rotation_xyzw")};
  const Twist twist{vector_from(linear, "linear_velocity_m_per_s", kFastest),
                    vector_from(angular, "angular_velocity_rad_per_s", kFastest)};
  session.guide_probe(probe, pose, twist);
}

/// None is no file; an empty name is a mistake, not none.
std::string file_named(const std::optional<std::string>& file, const char* argument) {
  if (file && file->empty()) {
    throw InputError(std::string(argument) + ": an empty path names no file");
  }
  return file.value_or("");
}

}  // namespace

void bind_session(py::module_& module) {
  py::class_<Session>(module, "Session")
      .def(py::init([](const scene::SceneDocument& scene, const std::optional<std::string>& record,
                       const std::optional<std::string>& from_snapshot) {
             return std::make_unique<Session>(scene.scene(), file_named(record, "record"),
                                              file_named(from_snapshot, "from_snapshot"));
           }),
           py::arg("scene"), py::arg("record"), py::arg("from_snapshot"))
      .def("run_until", &Session::run_until)
      .def("step", &Session::step)
      .def("settle", &Session::settle)
      .def("run_keeping", &Session::run_keeping)
      .def("save_snapshot",
           [](Session& session, const std::string& file, bool overwrite) {
             return session.save_snapshot(file_named(file, "file"), overwrite);
           })
      .def("close", &Session::close)
      .def("guide_probe", &guide_probe)
      .def("ask_for_volume", &Session::ask_for_volume)
      .def("newest", &Session::newest)
      .def("guards", &Session::guards)
      .def_property_readonly("time", &Session::time)
      .def_property_readonly("period", &Session::period)
      .def_property_readonly("closed", &Session::closed);
}

}  // namespace palpate::python
