// Codecs of what is sent per organ: the large messages.
#include "idl/NodePositions.h"
#include "idl/SurfaceTopology.h"
#include "modules/bus/codec.h"
#include "modules/bus/codec_fields.h"
#include "modules/messages/message_checks.h"

namespace palpate::bus {
namespace {

// Lists on the wire are flat, so that they are copied as blocks.

void encode_triangles(const SurfaceTopology& message, std::vector<std::uint32_t>& nodes) {
  nodes.resize(3 * message.triangles.size());
  for (std::size_t i = 0; i < message.triangles.size(); ++i) {
    std::copy_n(message.triangles[i].begin(), 3, nodes.begin() + static_cast<long>(3 * i));
  }
}

const char* decode_triangles(const std::vector<std::uint32_t>& nodes, SurfaceTopology& message) {
  if (nodes.size() % 3 != 0 || nodes.size() / 3 > kMaxTriangles) return "triangle_nodes";
  message.triangles.resize(nodes.size() / 3);
  for (std::size_t i = 0; i < message.triangles.size(); ++i) {
    message.triangles[i] = {nodes[3 * i], nodes[3 * i + 1], nodes[3 * i + 2]};
  }
  return nullptr;
}

void encode_springs(const SurfaceTopology& message, idl::SurfaceTopology& wire) {
  wire.spring_nodes().resize(2 * message.springs.size());
  wire.spring_families().resize(message.springs.size());
  for (std::size_t i = 0; i < message.springs.size(); ++i) {
    wire.spring_nodes()[2 * i] = message.springs[i].node_a;
    wire.spring_nodes()[2 * i + 1] = message.springs[i].node_b;
    wire.spring_families()[i] = static_cast<std::uint8_t>(message.springs[i].family);
  }
}

const char* decode_springs(const idl::SurfaceTopology& wire, SurfaceTopology& message) {
  const auto& nodes = wire.spring_nodes();
  const auto& families = wire.spring_families();
  if (nodes.size() % 2 != 0 || nodes.size() / 2 > kMaxSprings) return "spring_nodes";
  if (families.size() != nodes.size() / 2) return "spring_families";
  message.springs.resize(families.size());
  for (std::size_t i = 0; i < families.size(); ++i) {
    message.springs[i] = {nodes[2 * i], nodes[2 * i + 1], static_cast<SpringFamily>(families[i])};
  }
  return nullptr;
}

}  // namespace

const char* encode(const NodePositions& message, idl::NodePositions& wire) {
  if (const char* field = first_invalid_field(message)) return field;
  encode_header(message.header, wire);
  wire.organ(message.organ);
  wire.generation(message.generation);
  wire.volume_m3(message.volume);
  wire.target_volume_m3(message.target_volume);
  wire.pressure_pa(message.pressure);
  wire.kinetic_energy_j(message.kinetic_energy);
  wire.elastic_energy_j(message.elastic_energy);
  wire.positions_m(message.positions);
  return nullptr;
}

const char* decode(const idl::NodePositions& wire, NodePositions& message) {
  if (wire.positions_m().size() > 3 * kMaxNodes) return "positions_m";
  message.header = decode_header(wire);
  message.organ = wire.organ();
  message.generation = wire.generation();
  message.volume = wire.volume_m3();
  message.target_volume = wire.target_volume_m3();
  message.pressure = wire.pressure_pa();
  message.kinetic_energy = wire.kinetic_energy_j();
  message.elastic_energy = wire.elastic_energy_j();
  message.positions = wire.positions_m();
  return first_invalid_field(message);
}

const char* encode(const SurfaceTopology& message, idl::SurfaceTopology& wire) {
  if (const char* field = first_invalid_field(message)) return field;
  encode_header(message.header, wire);
  wire.organ(message.organ);
  wire.generation(message.generation);
  wire.name(message.name);
  wire.surface_node_count(message.surface_node_count);
  wire.rest_positions_m(message.rest_positions);
  encode_triangles(message, wire.triangle_nodes());
  wire.fixed_nodes(message.fixed_nodes);
  encode_springs(message, wire);
  return nullptr;
}

const char* decode(const idl::SurfaceTopology& wire, SurfaceTopology& message) {
  if (wire.rest_positions_m().size() > 3 * kMaxNodes) return "rest_positions_m";
  if (wire.fixed_nodes().size() > kMaxNodes) return "fixed_nodes";
  message.header = decode_header(wire);
  message.organ = wire.organ();
  message.generation = wire.generation();
  message.name = wire.name();
  message.surface_node_count = wire.surface_node_count();
  message.rest_positions = wire.rest_positions_m();
  if (const char* field = decode_triangles(wire.triangle_nodes(), message)) return field;
  message.fixed_nodes = wire.fixed_nodes();
  if (const char* field = decode_springs(wire, message)) return field;
  return first_invalid_field(message);
}

}  // namespace palpate::bus
