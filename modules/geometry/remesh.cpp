#include "modules/geometry/remesh.h"

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"

namespace palpate::geometry {
namespace {

constexpr double kLeastNormalCosine = 0.3;  // between a triangle before and after a change
constexpr double kGoodAspect = 3;           // up to which a change may make a triangle worse

using Vertex = RemeshMesh::VertexHandle;
using Edge = RemeshMesh::EdgeHandle;
using Halfedge = RemeshMesh::HalfedgeHandle;

Vec3 position(const RemeshMesh& mesh, Vertex v) { return to_vec3(mesh.point(v)); }

Vec3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

/// Whether both vectors point the same way, within the allowed angle; false for zero vectors.
bool agree(const Vec3& before, const Vec3& after) {
  return before.dot(after) > kLeastNormalCosine * before.norm() * after.norm();
}

/// Whether the triangles around v, without those that also hold `except`, keep their direction
/// when v moves to `place`.
bool may_move(const RemeshMesh& mesh, Vertex v, const Vec3& place, Vertex except = Vertex()) {
  for (const Halfedge spoke : mesh.voh_range(v)) {
    const Vertex b = mesh.to_vertex_handle(spoke);
    const Vertex c = mesh.to_vertex_handle(mesh.next_halfedge_handle(spoke));
    if (b == except || c == except) continue;
    const Vec3 x_b = position(mesh, b), x_c = position(mesh, c);
    if (!agree(normal_of(position(mesh, v), x_b, x_c), normal_of(place, x_b, x_c))) return false;
  }
  return true;
}

/// √3/4 · (longest edge)² / area: 1 for an equilateral triangle, infinite without area.
double aspect_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest_squared =
      std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return std::sqrt(3.0) / 2 * longest_squared / normal_of(a, b, c).norm();
}

bool is_good_enough(double aspect, double before) {
  return aspect <= std::max(before, kGoodAspect);
}

/// Worst aspect of the triangles around v, were it at `place`.
double worst_aspect_around(const RemeshMesh& mesh, Vertex v, const Vec3& place) {
  double worst = 0;
  for (const Halfedge spoke : mesh.voh_range(v)) {
    const Vertex b = mesh.to_vertex_handle(spoke);
    const Vertex c = mesh.to_vertex_handle(mesh.next_halfedge_handle(spoke));
    worst = std::max(worst, aspect_of(place, position(mesh, b), position(mesh, c)));
  }
  return worst;
}

bool makes_long_edge(const RemeshMesh& mesh, Vertex v, const Vec3& place, double longest) {
  return std::any_of(mesh.cvv_begin(v), mesh.cvv_end(v), [&](Vertex neighbour) {
    return (position(mesh, neighbour) - place).norm() > longest;
  });
}

int valence_error(const RemeshMesh& mesh, Vertex v, int change) {
  const int difference = static_cast<int>(mesh.valence(v)) + change - 6;
  return difference * difference;
}

bool flip_improves(const RemeshMesh& mesh, Edge edge) {
  const Halfedge one = mesh.halfedge_handle(edge, 0), two = mesh.halfedge_handle(edge, 1);
  const Vertex a = mesh.from_vertex_handle(one), b = mesh.to_vertex_handle(one);
  const Vertex c = mesh.to_vertex_handle(mesh.next_halfedge_handle(one));
  const Vertex d = mesh.to_vertex_handle(mesh.next_halfedge_handle(two));
  const int before = valence_error(mesh, a, 0) + valence_error(mesh, b, 0) +
                     valence_error(mesh, c, 0) + valence_error(mesh, d, 0);
  const int after = valence_error(mesh, a, -1) + valence_error(mesh, b, -1) +
                    valence_error(mesh, c, 1) + valence_error(mesh, d, 1);
  if (after >= before || mesh.valence(a) <= 3 || mesh.valence(b) <= 3) return false;
  const Vec3 x_a = position(mesh, a), x_b = position(mesh, b), x_c = position(mesh, c),
             x_d = position(mesh, d);
  const Vec3 old_sum = normal_of(x_a, x_b, x_c) + normal_of(x_b, x_a, x_d);
  const Vec3 new_1 = normal_of(x_a, x_d, x_c), new_2 = normal_of(x_d, x_b, x_c);
  const Vec3 old_1 = normal_of(x_a, x_b, x_c), old_2 = normal_of(x_b, x_a, x_d);
  const bool no_sharper = new_1.normalized().dot(new_2.normalized()) >
                          std::min(0.8, old_1.normalized().dot(old_2.normalized()) - 0.05);
  const double old_aspect = std::max(aspect_of(x_a, x_b, x_c), aspect_of(x_b, x_a, x_d));
  const double new_aspect = std::max(aspect_of(x_a, x_d, x_c), aspect_of(x_d, x_b, x_c));
  return no_sharper && is_good_enough(new_aspect, old_aspect) && agree(old_sum, new_1) &&
         agree(old_sum, new_2);
}

/// Passes on one call of some thousand, a few milliseconds.
class RarePulse {
 public:
  explicit RarePulse(const Pulse& pulse) : pulse_(pulse) {}
  void operator()() {
    constexpr std::size_t kEvery = 4096;
    if (++calls_ % kEvery == 0 && pulse_) pulse_();
  }

 private:
  const Pulse& pulse_;
  std::size_t calls_ = 0;
};

}  // namespace

RemeshMesh to_remesh_mesh(const TriangleSurface& surface) {
  RemeshMesh mesh;
  for (const Vec3& node : surface.nodes) mesh.add_vertex(to_point(node));
  for (const auto& [a, b, c] : surface.triangles) {
    const auto face = mesh.add_face(Vertex(static_cast<int>(a)), Vertex(static_cast<int>(b)),
                                    Vertex(static_cast<int>(c)));
    PALPATE_DEMAND(face.is_valid());
  }
  return mesh;
}

TriangleSurface to_surface(const RemeshMesh& mesh) {
  TriangleSurface surface;
  for (const Vertex v : mesh.vertices()) surface.nodes.push_back(position(mesh, v));
  for (const auto face : mesh.faces()) {
    Triangle triangle{};
    int i = 0;
    for (const Vertex v : mesh.fv_range(face)) triangle[i++] = static_cast<std::uint32_t>(v.idx());
    surface.triangles.push_back(triangle);
  }
  return surface;
}

std::vector<std::pair<double, Edge>> edges_by_length(const RemeshMesh& mesh) {
  std::vector<std::pair<double, Edge>> edges;
  edges.reserve(mesh.n_edges());
  for (const Edge edge : mesh.edges()) edges.emplace_back(mesh.calc_edge_length(edge), edge);
  std::sort(edges.begin(), edges.end());
  return edges;
}

std::size_t split_long_edges(RemeshMesh& mesh, double longest, std::size_t most_nodes) {
  const auto edges = edges_by_length(mesh);
  std::vector<bool> touched(mesh.n_vertices(), false);  // new nodes never end an old edge
  std::size_t count = 0;
  for (auto entry = edges.rbegin(); entry != edges.rend(); ++entry) {
    const auto& [length, edge] = *entry;
    if (length <= longest || mesh.n_vertices() >= most_nodes) break;
    const Halfedge one = mesh.halfedge_handle(edge, 0), two = mesh.halfedge_handle(edge, 1);
    const std::array<Vertex, 2> opposite{mesh.to_vertex_handle(mesh.next_halfedge_handle(one)),
                                         mesh.to_vertex_handle(mesh.next_halfedge_handle(two))};
    const auto is_touched = [&](Vertex v) {
      return v.idx() >= static_cast<int>(touched.size()) || touched[v.idx()];
    };
    if (is_touched(opposite[0]) && is_touched(opposite[1])) continue;
    for (const Vertex v : opposite) {
      if (v.idx() < static_cast<int>(touched.size())) touched[v.idx()] = true;
    }
    mesh.split(
        edge,
        (mesh.point(mesh.to_vertex_handle(one)) + mesh.point(mesh.from_vertex_handle(one))) * 0.5);
    ++count;
  }
  return count;
}

std::size_t collapse_short_edges(RemeshMesh& mesh, const AabbTree& target, double shortest,
                                 double longest, std::size_t fewest_nodes, const Pulse& pulse) {
  RarePulse now_and_then(pulse);
  const auto edges = edges_by_length(mesh);
  std::vector<bool> touched(mesh.n_vertices(), false);
  std::size_t left = mesh.n_vertices(), count = 0;
  for (const auto& [length, edge] : edges) {
    now_and_then();
    if (length >= shortest || left <= std::max<std::size_t>(fewest_nodes, 4)) break;
    if (mesh.status(edge).deleted()) continue;
    const Halfedge halfedge = mesh.halfedge_handle(edge, 0);
    const Vertex gone = mesh.from_vertex_handle(halfedge), kept = mesh.to_vertex_handle(halfedge);
    if (touched[gone.idx()] || touched[kept.idx()] || !mesh.is_collapse_ok(halfedge)) continue;
    const Vec3 place = target.nearest((position(mesh, gone) + position(mesh, kept)) / 2).point;
    if (makes_long_edge(mesh, gone, place, longest) ||
        makes_long_edge(mesh, kept, place, longest) || !may_move(mesh, gone, place, kept) ||
        !may_move(mesh, kept, place, gone)) {
      continue;
    }
    mesh.collapse(halfedge);
    mesh.set_point(kept, to_point(place));
    touched[kept.idx()] = true;
    for (const Vertex v : mesh.vv_range(kept)) touched[v.idx()] = true;
    --left;
    ++count;
  }
  mesh.garbage_collection();
  return count;
}

std::size_t equalize_valences(RemeshMesh& mesh, const Pulse& pulse) {
  RarePulse now_and_then(pulse);
  std::size_t count = 0;
  for (const Edge edge : mesh.edges()) {
    now_and_then();
    if (!flip_improves(mesh, edge) || !mesh.is_flip_ok(edge)) continue;
    mesh.flip(edge);
    ++count;
  }
  return count;
}

void relax_on(RemeshMesh& mesh, const AabbTree& target, const Pulse& pulse) {
  RarePulse now_and_then(pulse);
  for (const Vertex v : mesh.vertices()) {
    now_and_then();
    const Vec3 here = position(mesh, v);
    Vec3 normal = Vec3::Zero(), centre = Vec3::Zero();
    double weight = 0;
    for (const Halfedge spoke : mesh.voh_range(v)) {
      const Vec3 x_b = position(mesh, mesh.to_vertex_handle(spoke));
      const Vec3 x_c = position(mesh, mesh.to_vertex_handle(mesh.next_halfedge_handle(spoke)));
      const Vec3 twice_area = normal_of(here, x_b, x_c);
      const double area = twice_area.norm();
      normal += twice_area;
      centre += area * (here + x_b + x_c) / 3;
      weight += area;
    }
    if (weight == 0 || normal.norm() == 0) continue;
    normal.normalize();
    Vec3 move = centre / weight - here;
    move -= normal.dot(move) * normal;
    const Vec3 place = target.nearest(here + move).point;
    const bool stays_good =
        is_good_enough(worst_aspect_around(mesh, v, place), worst_aspect_around(mesh, v, here));
    if (stays_good && may_move(mesh, v, place)) mesh.set_point(v, to_point(place));
  }
}

}  // namespace palpate::geometry
