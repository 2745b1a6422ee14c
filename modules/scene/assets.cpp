#include "modules/scene/assets.h"

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/models.h"

namespace palpate::scene {
namespace {

geometry::TriangleSurface load(const Mesh& mesh, const std::string& owner) {
  try {
    return geometry::load_organ_surface(mesh.file, mesh.unit, mesh.nodes);
  } catch (const InputError& error) {
    throw InputError(owner + ": " + error.what());
  }
}

bool holds_tetrahedra(const std::filesystem::path& file) {
  return file.extension() == ".msh" || file.extension() == ".vtk";
}

geometry::OrganShape load_tetrahedra(const Mesh& mesh, const std::string& owner) {
  try {
    if (mesh.nodes != 0) {
      throw InputError(mesh.file.string() +
                       ": key 'nodes' resamples surfaces only; tetrahedra stay as they are (0)");
    }
    auto tetrahedra = geometry::read_tetrahedra(mesh.file);
    const double scale = metres_per_unit(mesh.unit);
    for (Vec3& node : tetrahedra.nodes) node *= scale;
    return geometry::shape_of(tetrahedra);
  } catch (const InputError& error) {
    throw InputError(owner + ": " + error.what());
  }
}

geometry::OrganShape filled(const geometry::TriangleSurface& surface, const Solid& solid,
                            const std::string& owner) {
  try {
    const double size =
        solid.element_size > 0 ? solid.element_size : geometry::mean_edge_length(surface);
    return geometry::shape_of(geometry::fill_surface(surface, size));
  } catch (const InputError& error) {
    throw InputError(owner + ": " + error.what());
  }
}

}  // namespace

geometry::OrganShape load_organ(const Organ& organ) {
  const std::string owner = "organ '" + organ.name + "'";
  const ModelFormat& format = format_of(organ.model);
  geometry::OrganShape shape;
  if (holds_tetrahedra(organ.mesh.file)) {
    shape = load_tetrahedra(organ.mesh, owner);
    if (!format.is_solid()) shape = geometry::OrganShape(std::move(shape.surface));
  } else {
    shape = geometry::OrganShape(load(organ.mesh, owner));
    if (format.is_solid()) shape = filled(shape.surface, organ.solid, owner);
  }
  if (format.is_quadratic()) shape = geometry::with_edge_nodes(shape);
  for (auto* nodes : {&shape.surface.nodes, &shape.inner_nodes}) {
    for (Vec3& node : *nodes) node = organ.pose.to_world(node);
  }
  return shape;
}

geometry::TriangleSurface load_probe_mesh(const Probe& probe) {
  const Mesh* mesh = mesh_of(probe.shape);
  if (mesh == nullptr) return {};
  return load(*mesh, "probe '" + probe.name + "'");
}

}  // namespace palpate::scene
