// The wording half of mesh_check.h.
#include <iomanip>
#include <sstream>

#include "modules/geometry/mesh_check.h"

namespace palpate::geometry {
namespace {

std::string written(const Vec3& point) {
  std::ostringstream text;
  text << std::setprecision(4) << "(" << point.x() << ", " << point.y() << ", " << point.z()
       << ") m";
  return text.str();
}

/// "1 open edge" or "12 open edges, the first"
std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return count == 1 ? "1 " + one + ":" : std::to_string(count) + " " + many + ", the first:";
}

std::string edge_place(const std::array<std::uint32_t, 2>& edge, const TriangleSurface& surface) {
  return " nodes " + std::to_string(edge[0]) + "–" + std::to_string(edge[1]) + " at " +
         written((surface.nodes[edge[0]] + surface.nodes[edge[1]]) / 2);
}

std::string node_place(std::uint32_t node, const TriangleSurface& surface) {
  return " node " + std::to_string(node) + " at " + written(surface.nodes[node]);
}

std::string triangle_place(std::uint32_t index, const TriangleSurface& surface) {
  const auto& [a, b, c] = surface.triangles[index];
  return " triangle " + std::to_string(index) + " at " +
         written((surface.nodes[a] + surface.nodes[b] + surface.nodes[c]) / 3);
}

void describe_topology(const MeshReport& report, const TriangleSurface& surface,
                       std::vector<std::string>& lines) {
  if (const auto& edges = report.border_edges; !edges.empty()) {
    lines.push_back(
        counted(edges.size(), "open edge", "open edges") + edge_place(edges[0], surface) +
        "; the surface leaks: fill its holes (palpate mesh --fill-holes, or a mesh editor)");
  }
  if (const auto& edges = report.non_manifold_edges; !edges.empty()) {
    lines.push_back(counted(edges.size(), "edge with more than two triangles",
                            "edges with more than two triangles") +
                    edge_place(edges[0], surface) + "; remove the inner walls or flaps there");
  }
  if (const auto& nodes = report.non_manifold_nodes; !nodes.empty()) {
    lines.push_back(counted(nodes.size(), "node where parts of the surface touch only in a point",
                            "nodes where parts of the surface touch only in a point") +
                    node_place(nodes[0], surface) + "; separate the parts or join them properly");
  }
  if (report.component_count > 1) {
    lines.push_back(std::to_string(report.component_count) +
                    " separate shells; one organ is one shell: drop inner cavities and loose "
                    "pieces (palpate mesh --largest), or save each shell as an organ of its own");
  }
}

void describe_orientation(const MeshReport& report, const TriangleSurface& surface,
                          std::vector<std::string>& lines) {
  if (const auto& edges = report.inconsistent_edges; !edges.empty()) {
    lines.push_back(counted(edges.size(), "edge between oppositely oriented triangles",
                            "edges between oppositely oriented triangles") +
                    edge_place(edges[0], surface) +
                    "; orient the triangles (palpate mesh does), and if that fails the surface "
                    "has no inside, like a Möbius strip");
  }
  if (report.inside_out) {
    lines.push_back(
        "inside out: the enclosed volume is negative; flip all triangles (palpate "
        "mesh does)");
  }
}

void describe_triangles(const MeshReport& report, const TriangleSurface& surface,
                        std::vector<std::string>& lines) {
  if (const auto& pairs = report.self_intersections; !pairs.empty()) {
    lines.push_back(counted(pairs.size(), "pair of triangles pass through each other",
                            "pairs of triangles pass through each other") +
                    triangle_place(pairs[0][0], surface) + " and triangle " +
                    std::to_string(pairs[0][1]) +
                    "; separate or merge these parts in a mesh editor, or smooth there");
  }
  if (const auto& triangles = report.duplicate_triangles; !triangles.empty()) {
    lines.push_back(counted(triangles.size(), "duplicate triangle", "duplicate triangles") +
                    triangle_place(triangles[0], surface) + "; remove (palpate mesh does)");
  }
  if (const auto& triangles = report.degenerate_triangles; !triangles.empty()) {
    lines.push_back(counted(triangles.size(), "triangle without area", "triangles without area") +
                    triangle_place(triangles[0], surface) +
                    "; collapse its shortest edge in a mesh editor");
  }
  if (const auto& nodes = report.unused_nodes; !nodes.empty()) {
    lines.push_back(counted(nodes.size(), "node of no triangle", "nodes of no triangle") +
                    node_place(nodes[0], surface) + "; remove (palpate mesh does)");
  }
}

}  // namespace

std::vector<std::string> describe_problems(const MeshReport& report,
                                           const TriangleSurface& surface) {
  std::vector<std::string> lines;
  if (report.triangle_count == 0) {
    lines.emplace_back("no triangles; export the organ's surface as triangles");
    return lines;
  }
  describe_topology(report, surface, lines);
  describe_orientation(report, surface, lines);
  describe_triangles(report, surface, lines);
  if (lines.empty() && !(report.volume > 0)) {
    lines.emplace_back("encloses no volume; the surface is flat");
  }
  return lines;
}

}  // namespace palpate::geometry
