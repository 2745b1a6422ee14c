#include "modules/scene/assets.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "modules/core/error.h"
#include "modules/core/organ_limits.h"
#include "modules/core/units.h"
#include "modules/geometry/bisection.h"
#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/models.h"
#include "modules/scene/region.h"
#include "modules/scene/spring_count.h"

namespace palpate::scene {
namespace {

using Admit = std::function<void(const geometry::TriangleSurface&)>;

geometry::TriangleSurface load(const Mesh& mesh, const std::string& owner,
                               const Resampling& resampling = {}, const Admit& admit = {}) {
  try {
    return geometry::load_organ_surface(mesh.file, mesh.unit, mesh.nodes, admit, [&](double part) {
      if (resampling) resampling(owner, part);
    });
  } catch (const InputError& error) {
    throw InputError(owner + ": " + error.what());
  }
}

/// Of a refined mesh; a step of so many is minutes.
constexpr std::size_t kMostRefinedNodes = 50'000;

geometry::OrganShape load_tetrahedra(const Organ& organ, const std::string& owner) {
  const Mesh& mesh = organ.mesh;
  try {
    if (mesh.nodes != 0) {
      throw InputError(mesh.file.string() +
                       ": key 'nodes' resamples surfaces only; tetrahedra stay as they are (0)");
    }
    auto tetrahedra = geometry::read_tetrahedra(mesh.file);
    const double scale = metres_per_unit(mesh.unit);
    for (Vec3& node : tetrahedra.nodes) node *= scale;
    return geometry::shape_of(refined(tetrahedra, organ));
  } catch (const InputError& error) {
    throw InputError(owner + ": " + error.what());
  }
}

geometry::OrganShape filled(const geometry::TriangleSurface& surface, const Organ& organ,
                            const std::string& owner) {
  try {
    const double size = organ.solid.element_size > 0 ? organ.solid.element_size
                                                     : geometry::mean_edge_length(surface);
    return geometry::shape_of(refined(geometry::fill_surface(surface, size), organ));
  } catch (const InputError& error) {
    throw InputError(owner + ": " + error.what());
  }
}

/// What is larger no message holds: it would never be heard of.
void check_size(const geometry::OrganShape& shape, const std::string& owner) {
  const std::size_t nodes = shape.surface.nodes.size() + shape.inner_nodes.size();
  const std::size_t triangles = shape.surface.triangles.size();
  if (nodes <= kMaxNodes && triangles <= kMaxTriangles) return;
  throw InputError(owner + ": " + std::to_string(nodes) + " nodes and " +
                   std::to_string(triangles) + " triangles; at most " + std::to_string(kMaxNodes) +
                   " and " + std::to_string(kMaxTriangles) +
                   " go over the wire; key 'mesh.nodes' resamples a surface");
}

}  // namespace

geometry::TetMesh refined(const geometry::TetMesh& mesh, const Refinement& refine,
                          const Pose& pose) {
  if (refine.near.empty()) return mesh;
  const double edge = refine.edge_length.value_or(Refinement::kRegionEdge);
  const double growth = refine.growth.value_or(Refinement::kGrowth);
  const auto longest_edge = [&](const Vec3& x) {
    double least = std::numeric_limits<double>::infinity();
    for (const Region& region : refine.near) {
      least = std::min(least, distance(region, pose.to_world(x)));
    }
    return edge + growth * least;
  };
  return geometry::bisected(mesh, longest_edge, kMostRefinedNodes);
}

geometry::TetMesh refined(const geometry::TetMesh& mesh, const Organ& organ) {
  try {
    return refined(mesh, organ.solid.refine, organ.pose);
  } catch (const InputError& error) {
    throw InputError(std::string("key 'solid.refine': ") + error.what());
  }
}

geometry::TriangleSurface load_skin(const Organ& organ, const Resampling& resampling) {
  const std::string owner = "organ '" + organ.name + "'";
  geometry::TriangleSurface skin;
  if (geometry::is_tetrahedra_file(organ.mesh.file)) {
    Organ coarse = organ;
    coarse.solid.refine = {};
    skin = load_tetrahedra(coarse, owner).surface;
  } else {
    skin = load(organ.mesh, owner, resampling);
  }
  for (Vec3& node : skin.nodes) node = organ.pose.to_world(node);
  return skin;
}

geometry::OrganShape load_organ(const Organ& organ, const Resampling& resampling) {
  const std::string owner = "organ '" + organ.name + "'";
  const ModelFormat& format = format_of(organ.model);
  geometry::OrganShape shape;
  if (geometry::is_tetrahedra_file(organ.mesh.file)) {
    shape = load_tetrahedra(organ, owner);
    if (!format.is_solid()) shape = geometry::OrganShape(std::move(shape.surface));
  } else {
    const Admit count_springs = [&](const geometry::TriangleSurface& surface) {
      if (!format.is_solid()) check_spring_count(surface, organ.springs);
    };
    shape = geometry::OrganShape(load(organ.mesh, owner, resampling, count_springs));
    if (format.is_solid()) shape = filled(shape.surface, organ, owner);
  }
  for (auto* nodes : {&shape.surface.nodes, &shape.inner_nodes}) {
    for (Vec3& node : *nodes) node = organ.pose.to_world(node);
  }
  // In W, where meshes of its halves have the same middles to the bit.
  if (format.is_quadratic()) shape = geometry::with_edge_nodes(shape);
  check_size(shape, owner);
  return shape;
}

geometry::TriangleSurface load_probe_mesh(const Probe& probe) {
  const Mesh* mesh = mesh_of(probe.shape);
  if (mesh == nullptr) return {};
  return load(*mesh, "probe '" + probe.name + "'");
}

std::vector<geometry::TriangleSurface> load_probe_meshes(const Scene& scene) {
  std::vector<geometry::TriangleSurface> meshes;
  for (const Probe& probe : scene.probes) meshes.push_back(load_probe_mesh(probe));
  return meshes;
}

}  // namespace palpate::scene
