#include "studies/paper/shape_files.h"

#include "studies/report/table_file.h"

namespace palpate::paper {
namespace {

constexpr double kFreeSurface = 0, kFixedSurface = 1, kVirtual = 2;

}  // namespace

void write_topology(const SurfaceTopology& topology, const std::filesystem::path& folder,
                    const std::string& name, bool springs) {
  report::TableFile triangles(folder / (name + "_triangles.csv"), {"a", "b", "c"});
  for (const auto& t : topology.triangles) {
    triangles.write_row({double(t[0]), double(t[1]), double(t[2])});
  }
  triangles.finish();
  if (!springs) return;
  report::TableFile table(folder / (name + "_springs.csv"), {"family", "a", "b"});
  for (const auto& spring : topology.springs) {
    table.write_row({double(spring.family), double(spring.node_a), double(spring.node_b)});
  }
  table.finish();
}

void write_nodes(const SurfaceTopology& topology, const std::vector<float>& positions,
                 const std::filesystem::path& folder, const std::string& name) {
  std::vector<double> kinds(topology.rest_positions.size() / 3, kFreeSurface);
  std::fill(kinds.begin() + topology.surface_node_count, kinds.end(), kVirtual);
  for (const auto i : topology.fixed_nodes) kinds[i] = kFixedSurface;
  report::TableFile table(folder / (name + "_nodes.csv"),
                          {"x_m", "y_m", "z_m", "rest_x_m", "rest_y_m", "rest_z_m", "kind"});
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const float* p = positions.data() + 3 * i;
    const float* rest = topology.rest_positions.data() + 3 * i;
    table.write_row({p[0], p[1], p[2], rest[0], rest[1], rest[2], kinds[i]});
  }
  table.finish();
}

}  // namespace palpate::paper
