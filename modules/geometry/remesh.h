// Isotropic remeshing steps on a half-edge mesh. Botsch & Kobbelt, "A remeshing approach to
// multiresolution modeling", Symposium on Geometry Processing 2004.
// Explicit mass-spring steps are limited by the shortest edge, so equal edges are worth most.
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <functional>

#include "modules/geometry/aabb_tree.h"

namespace palpate::geometry {

struct RemeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};
using RemeshMesh = OpenMesh::TriMesh_ArrayKernelT<RemeshTraits>;

/// @param surface  closed, manifold, consistently oriented
RemeshMesh to_remesh_mesh(const TriangleSurface& surface);
TriangleSurface to_surface(const RemeshMesh& mesh);

/// Called now and then by what takes long; may throw to end it.
using Pulse = std::function<void()>;

/// Halves edges longer than `longest` [m], longest first, stopping at `most_nodes`.
/// @return number of splits in this sweep; edges next to a split wait for the next sweep
std::size_t split_long_edges(RemeshMesh& mesh, double longest, std::size_t most_nodes);

/// Collapses edges shorter than `shortest` [m], shortest first, stopping at `fewest_nodes`; the
/// joined node goes to the nearest point of `target`. Collapses that would change the topology,
/// turn a triangle over or make an edge longer than `longest` [m] are left out.
/// @return number of collapses in this sweep
std::size_t collapse_short_edges(RemeshMesh& mesh, const AabbTree& target, double shortest,
                                 double longest, std::size_t fewest_nodes, const Pulse& pulse = {});

/// Flips edges where that brings the valences nearer to six without folding the surface or making
/// bad triangles worse.
std::size_t equalize_valences(RemeshMesh& mesh, const Pulse& pulse = {});

/// Moves every node along the surface towards the area-weighted centre of its neighbours, then
/// to the nearest point of `target`; moves that would turn a triangle over, or make a bad one
/// worse, are left out.
void relax_on(RemeshMesh& mesh, const AabbTree& target, const Pulse& pulse = {});

/// Edges, shortest first; ties by index.
std::vector<std::pair<double, RemeshMesh::EdgeHandle>> edges_by_length(const RemeshMesh& mesh);

inline Vec3 to_vec3(const RemeshMesh::Point& p) { return {p[0], p[1], p[2]}; }
inline RemeshMesh::Point to_point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace palpate::geometry
