#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstring>

#include "modules/core/error.h"
#include "modules/core/organ_limits.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/mesh_prepare.h"
#include "python/bindings.h"
#include "python/numbers.h"
#include "python/unlocked.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

using geometry::TriangleSurface;
using IndexArray = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

constexpr double kLargest = 1e4;  ///< of a coordinate: squares and volumes stay numbers [m]

py::array checked_table(py::handle object, const char* name, const char* kinds) {
  py::array table = py::array::ensure(object);
  const bool numbers = table && std::strchr(kinds, table.dtype().kind()) != nullptr;
  PyErr_Clear();
  if (!numbers) throw py::type_error(std::string(name) + " must be an array of numbers");
  if (table.ndim() != 2 || table.shape(1) != 3)
    throw py::value_error(std::string(name) + " must have shape (n, 3), not " +
                          std::string(py::str(table.attr("shape"))));
  return table;
}

std::vector<Vec3> nodes_from(py::handle object) {
  const DoubleArray array = doubles_from(checked_table(object, "nodes", "iuf"), "nodes");
  if (array.shape(0) > static_cast<py::ssize_t>(kMaxNodes))
    throw py::value_error("nodes: at most " + std::to_string(kMaxNodes));
  std::vector<Vec3> nodes;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    nodes.emplace_back(array.at(i, 0), array.at(i, 1), array.at(i, 2));
    if (nodes.back().cwiseAbs().maxCoeff() > kLargest)
      throw py::value_error("nodes: each coordinate must be between -1e4 and 1e4 m");
  }
  return nodes;
}

TriangleSurface surface_from(py::handle nodes, py::handle triangles) {
  TriangleSurface surface{nodes_from(nodes), {}};
  const auto array = IndexArray::ensure(checked_table(triangles, "triangles", "iu"));
  if (!array) throw py::error_already_set();
  if (array.shape(0) > static_cast<py::ssize_t>(kMaxTriangles))
    throw py::value_error("triangles: at most " + std::to_string(kMaxTriangles));
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    geometry::Triangle triangle{};
    for (py::ssize_t k = 0; k < 3; ++k) {
      const std::int64_t node = array.at(i, k);
      if (node < 0 || static_cast<std::size_t>(node) >= surface.nodes.size())
        throw py::index_error("triangles[" + std::to_string(i) + "] names node " +
                              std::to_string(node) + "; there are " +
                              std::to_string(surface.nodes.size()));
      triangle[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(node);
    }
    surface.triangles.push_back(triangle);
  }
  return surface;
}

/// (nodes, triangles)
py::tuple arrays_from(const TriangleSurface& surface) {
  const auto nodes = static_cast<py::ssize_t>(surface.nodes.size());
  const auto triangles = static_cast<py::ssize_t>(surface.triangles.size());
  py::array_t<double> points({nodes, py::ssize_t{3}});
  py::array_t<std::uint32_t> corners({triangles, py::ssize_t{3}});
  for (py::ssize_t i = 0; i < nodes; ++i)
    std::memcpy(points.mutable_data(i, 0), surface.nodes[static_cast<std::size_t>(i)].data(),
                3 * sizeof(double));
  if (triangles > 0)
    std::memcpy(corners.mutable_data(), surface.triangles.data(),
                surface.triangles.size() * sizeof(geometry::Triangle));
  return py::make_tuple(points, corners);
}

py::dict check_mesh(py::handle nodes, py::handle triangles) {
  const TriangleSurface surface = surface_from(nodes, triangles);
  geometry::MeshReport report;
  std::vector<std::string> problems;
  {
    const Unlocked unlocked;
    report = geometry::check_surface(surface);
    problems = geometry::describe_problems(report, surface);
  }
  py::dict result;
  result["node_count"] = report.node_count;
  result["triangle_count"] = report.triangle_count;
  result["component_count"] = report.component_count;
  result["genus"] = report.genus;
  result["area_m2"] = report.area;
  result["volume_m3"] = report.volume;
  result["shortest_edge_m"] = report.shortest_edge;
  result["longest_edge_m"] = report.longest_edge;
  result["worst_aspect"] = report.worst_aspect;
  result["holds_volume"] = report.holds_volume();
  result["problems"] = problems;
  return result;
}

py::tuple repair_mesh(py::handle nodes, py::handle triangles) {
  TriangleSurface surface = surface_from(nodes, triangles);
  geometry::RepairLog log;
  {
    const Unlocked unlocked;
    log = geometry::repair_surface(surface);
  }
  const py::tuple repaired = arrays_from(surface);
  return py::make_tuple(repaired[0], repaired[1], log.actions);
}

/// As `palpate mesh` does it: what cannot hold a volume is refused, not made worse.
py::tuple resample_mesh(py::handle nodes, py::handle triangles, std::size_t node_count) {
  TriangleSurface surface = surface_from(nodes, triangles);
  if (node_count < 4 || node_count > kMaxNodes)
    throw py::value_error("node_count must be between 4 and " + std::to_string(kMaxNodes));
  {
    const Unlocked unlocked;
    const geometry::MeshReport report = geometry::check_surface(surface);
    if (!report.holds_volume()) {
      const auto problems = geometry::describe_problems(report, surface);
      throw InputError("the surface cannot hold a volume" +
                       (problems.empty() ? "" : ": " + problems.front()));
    }
    surface = geometry::resample_surface(surface, node_count);
  }
  return arrays_from(surface);
}

py::tuple read_mesh(const std::string& file, const std::string& unit) {
  return arrays_from(geometry::read_surface(file, unit));
}

void write_mesh(const std::string& file, py::handle nodes, py::handle triangles, bool overwrite) {
  geometry::check_can_write(file);
  if (!overwrite && std::filesystem::exists(file)) {
    throw InputError(file + ": is there already; give another name, or overwrite=True");
  }
  geometry::write_surface(surface_from(nodes, triangles), file);
}

}  // namespace

void bind_mesh(py::module_& module) {
  module.def("read_mesh", &read_mesh);
  module.def("write_mesh", &write_mesh);
  module.def("check_mesh", &check_mesh);
  module.def("repair_mesh", &repair_mesh);
  module.def("resample_mesh", &resample_mesh);
}

}  // namespace palpate::python
