#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <limits>

#include "modules/messages/describe.h"
#include "python/bindings.h"
#include "python/live.h"
#include "python/numbers.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

constexpr double kAny = 1e30;  ///< what a message may hold

SessionCommand command_from(const std::string& word) {
  const auto& words = messages::Words<SessionCommand>::texts;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto command = static_cast<SessionCommand>(i);
    if (word == words[i] && command != SessionCommand::kStep) return command;
  }
  throw py::value_error("a command is start, pause, reset or stop, not '" + word + "'");
}

bool write_probe_input(Live& live, std::int64_t probe, py::handle position, py::handle rotation,
                       py::handle linear, py::handle angular, std::uint32_t buttons) {
  if (probe < 0 || probe > std::numeric_limits<std::uint32_t>::max()) {
    throw py::index_error("no probe " + std::to_string(probe) + ": they count from 0");
  }
  ProbeState state;
  state.probe = static_cast<std::uint32_t>(probe);
  state.pose = {vector_from(position, "position_m", kAny),
                rotation_from(rotation, "rotation_xyzw")};
  state.twist = {vector_from(linear, "linear_velocity_m_per_s", kAny),
                 vector_from(angular, "angular_velocity_rad_per_s", kAny)};
  state.buttons = buttons;
  return live.write_probe_input(state);
}

}  // namespace

void bind_live(py::module_& module) {
  py::class_<Live>(module, "Live")
      .def(py::init<const std::string&, int>())
      .def("newest", &Live::newest)
      .def("take", &Live::take)
      .def("write_probe_input", &write_probe_input)
      .def("control", [](Live& live, const std::string& word,
                         double timeout) { return live.control(command_from(word), timeout); })
      .def("phase", &Live::phase)
      .def("wait_for_haptics", &Live::wait_for_haptics)
      .def("close", &Live::close)
      .def_property_readonly("closed", &Live::closed);
}

}  // namespace palpate::python
