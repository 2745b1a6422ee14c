#include "deformation/organ_messages.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "deformation/following_organ.h"
#include "modules/core/sort_unique.h"

namespace palpate::deformation {
namespace {

void write_float32(std::span<const Vec3> positions, std::vector<float>& out) {
  out.resize(3 * positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out[3 * i + axis] = static_cast<float>(positions[i][static_cast<Eigen::Index>(axis)]);
    }
  }
}

/// Each edge of the tetrahedra between their corners, once.
std::vector<std::array<std::uint32_t, 2>> edges_of(const TetMesh& mesh) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const geometry::Tetrahedron& corners : mesh.tetrahedra) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        edges.push_back({std::min(corners[i], corners[j]), std::max(corners[i], corners[j])});
      }
    }
  }
  sort_unique(edges);
  return edges;
}

SurfaceTopology surface_message(const OrganModel& model) {
  SurfaceTopology message;
  message.surface_node_count = static_cast<std::uint32_t>(model.surface_node_count);
  write_float32(model.rest_positions, message.rest_positions);
  message.triangles = model.triangles;
  message.triangle_blocks = geometry::SurfaceBlocks::split(model.rest_positions, model.triangles);
  message.fixed_nodes = model.fixed_nodes;
  if (model.is_solid()) {
    for (const auto& [a, b] : edges_of(model.mesh())) {
      message.springs.push_back({a, b, SpringFamily::kInner});
    }
    return message;
  }
  const SpringNetwork& network = model.network();
  for (std::size_t s = 0; s < network.springs.size(); ++s) {
    const Spring& spring = network.springs[s];
    message.springs.push_back({spring.node_a, spring.node_b, network.family(s)});
  }
  return message;
}

SurfaceTopology named(SurfaceTopology message, const DeformationWorld& world, std::size_t organ,
                      std::uint32_t generation) {
  message.organ = static_cast<std::uint32_t>(organ);
  message.generation = generation;
  message.name = world.name(organ);
  return message;
}

}  // namespace

SurfaceTopology surface_message(const DeformationWorld& world, std::size_t organ) {
  return named(surface_message(world.model(organ)), world, organ, world.generation(organ));
}

SurfaceTopology surface_message(const DeformationWorld& world, std::size_t organ,
                                const OrganMesh& next) {
  return named(surface_message(*next.model), world, organ, next.generation);
}

void write_node_positions(const DeformationWorld& world, std::size_t organ, double elastic_energy,
                          NodePositions& out) {
  const OrganReading reading = world.read(organ);
  out.organ = static_cast<std::uint32_t>(organ);
  out.generation = world.generation(organ);
  out.volume = reading.volume;
  out.target_volume = reading.target_volume;
  out.pressure = reading.pressure;
  out.kinetic_energy = reading.kinetic_energy;
  out.elastic_energy = elastic_energy;
  out.organ_contacts = static_cast<std::uint32_t>(reading.organ_contacts);
  write_float32(reading.positions, out.positions);
}

void write_node_positions(const DeformationWorld& world, std::size_t organ, NodePositions& out) {
  write_node_positions(world, organ, world.elastic_energy(organ), out);
}

void write_block_boxes(const geometry::SurfaceBlocks& blocks, NodePositions& out) {
  out.block_boxes.clear();
  for (std::size_t block = 0; block < blocks.count(); ++block) {
    const geometry::BlockBox box = blocks.box_of(block, out.positions);
    out.block_boxes.insert(out.block_boxes.end(), box.lower.begin(), box.lower.end());
    out.block_boxes.insert(out.block_boxes.end(), box.upper.begin(), box.upper.end());
  }
}

void note_extremes(const NodePositions& said, bool runs, OrganExtremes& of) {
  of.volume_ratio = said.target_volume > 0 ? said.volume / said.target_volume : 0;
  if (!runs) return;
  of.worst_volume_error = std::max(of.worst_volume_error, std::abs(of.volume_ratio - 1));
  of.lowest_pressure = std::min(of.lowest_pressure, said.pressure);
  of.highest_pressure = std::max(of.highest_pressure, said.pressure);
  of.most_contacts = std::max(of.most_contacts, said.organ_contacts);
}

ContactModel contact_model_message(const DeformationWorld& world, std::size_t probe,
                                   bool* bounded) {
  ContactModel message;
  static_cast<LocalLaw&>(message) = world.local_law(probe, bounded);
  message.probe = static_cast<std::uint32_t>(probe);
  return message;
}

}  // namespace palpate::deformation
