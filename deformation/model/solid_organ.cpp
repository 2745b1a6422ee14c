#include "deformation/model/organ_model.h"
#include "deformation/model/solid_masses.h"

namespace palpate::deformation {
namespace {

double volume_of(const geometry::Tetrahedron& t, const std::vector<Vec3>& nodes) {
  return geometry::tetrahedron_volume(nodes[t[0]], nodes[t[1]], nodes[t[2]], nodes[t[3]]);
}

void add_masses(const TetMesh& solid, Body& body) {
  for (std::size_t e = 0; e < solid.tetrahedra.size(); ++e) {
    const double mass = tetrahedron_mass(solid, e, body.rest_positions);
    const bool quadratic = !solid.edge_nodes.empty();
    for (const auto node : solid.tetrahedra[e]) {
      body.masses[node] += (quadratic ? kQuadraticCornerShare : 0.25) * mass;
    }
    if (!quadratic) continue;
    for (const auto node : solid.edge_nodes[e]) body.masses[node] += kQuadraticMiddleShare * mass;
  }
}

/// Upper bound of each node's stiffness with all others held: Σ V (λ + 3μ) |∇N|² over its
/// tetrahedra, with λ = 2μ, for averaged volumes do not hold single nodes. Middle nodes get the
/// mean of their ends.
void add_stiffness(const TetMesh& solid, Body& body) {
  const double shear = solid.elastic().shear_modulus();
  const auto& x = body.rest_positions;
  for (const auto& t : solid.tetrahedra) {
    const double volume = volume_of(t, x);
    for (std::size_t k = 0; k < 4; ++k) {
      // The area vector of the face opposite a corner is 3 V times its function's gradient.
      const Vec3 &a = x[t[(k + 1) % 4]], &b = x[t[(k + 2) % 4]], &c = x[t[(k + 3) % 4]];
      const double gradient = (b - a).cross(c - a).norm() / (6 * volume);
      body.node_stiffness[t[k]] += volume * 5 * shear * gradient * gradient;
    }
  }
  for (std::size_t e = 0; e < solid.edge_nodes.size(); ++e) {
    for (std::size_t k = 0; k < 6; ++k) {
      const auto& [a, b] = geometry::kTetrahedronEdges[k];
      body.node_stiffness[solid.edge_nodes[e][k]] = (body.node_stiffness[solid.tetrahedra[e][a]] +
                                                     body.node_stiffness[solid.tetrahedra[e][b]]) /
                                                    2;
    }
  }
}

}  // namespace

OrganModel build_solid(const scene::Organ& organ, const Vec3& gravity,
                       const geometry::OrganShape& shape) {
  OrganModel model;
  const TetMesh mesh{shape.tetrahedra, shape.edge_nodes, organ.tissue.youngs_modulus,
                     organ.solid.poisson_ratio, organ.tissue.density};
  model.surface_node_count = shape.surface.nodes.size();
  for (std::size_t i = 0; i < shape.node_count(); ++i) {
    model.rest_positions.push_back(shape.node(i));
  }
  model.triangles = shape.surface.triangles;
  model.rest_volume = geometry::enclosed_volume(shape.surface.nodes, shape.surface.triangles);
  model.masses.assign(shape.node_count(), 0);
  model.node_stiffness.assign(shape.node_count(), 0);
  add_masses(mesh, model);
  add_stiffness(mesh, model);
  for (const double mass : model.masses) model.inverse_masses.push_back(1 / mass);
  fix_nodes(organ, shape.node_count(), model);
  model.material = mesh;
  model.gravity = gravity;
  model.drag = organ.tissue.drag;
  return model;
}

}  // namespace palpate::deformation
