#include "tests/modules/bus/random_messages.h"

#include <limits>

namespace palpate::bus::testing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double real(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
std::uint64_t whole(Random& random, std::uint64_t low, std::uint64_t high) {
  return std::uniform_int_distribution<std::uint64_t>(low, high)(random);
}
std::uint32_t index(Random& random, std::size_t count) {
  return static_cast<std::uint32_t>(whole(random, 0, count - 1));
}
bool coin(Random& random) { return whole(random, 0, 1) == 1; }

Vec3 vector(Random& random) {
  return {real(random, -5, 5), real(random, -5, 5), real(random, -5, 5)};
}
Vec3 unit(Random& random) { return vector(random).normalized(); }
Pose pose(Random& random) {
  const Vec3 imaginary = vector(random);
  return {vector(random),
          Quat(real(random, -5, 5), imaginary.x(), imaginary.y(), imaginary.z()).normalized()};
}

std::string text(Random& random, std::size_t min_bytes, std::size_t max_bytes) {
  std::string s(whole(random, min_bytes, max_bytes), ' ');
  for (char& c : s) c = static_cast<char>(whole(random, 1, 255));
  return s;
}

Header header(Random& random) {
  return {whole(random, 1, ~std::uint64_t{0}), static_cast<std::int64_t>(random()),
          static_cast<std::int64_t>(random() >> 1)};
}

std::vector<float> positions(Random& random, std::size_t nodes) {
  std::vector<float> xyz(3 * nodes);
  for (float& x : xyz) x = static_cast<float>(real(random, -1, 1));
  return xyz;
}

bool equal(const Header& a, const Header& b) {
  return a.sequence == b.sequence && a.sim_time_ns == b.sim_time_ns &&
         a.source_time_ns == b.source_time_ns;
}
bool equal(const Pose& a, const Pose& b) {
  return a.position == b.position && a.rotation.coeffs() == b.rotation.coeffs();
}
bool equal(const Contact& a, const Contact& b) {
  return a.organ == b.organ && a.triangle == b.triangle && a.barycentric == b.barycentric &&
         a.point_on_probe == b.point_on_probe && a.normal == b.normal && a.gap == b.gap &&
         a.time_of_impact == b.time_of_impact;
}
bool equal(const SurfaceTopology::Spring& a, const SurfaceTopology::Spring& b) {
  return a.node_a == b.node_a && a.node_b == b.node_b && a.family == b.family;
}
bool equal(const ModuleStatus::Input& a, const ModuleStatus::Input& b) {
  return a.topic == b.topic && a.age == b.age && a.received == b.received &&
         a.dropped == b.dropped && a.rejected == b.rejected;
}

template <class List>
bool all_equal(const List& a, const List& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!equal(a[i], b[i])) return false;
  }
  return true;
}

}  // namespace

void fill(Random& random, ProbeState& m) {
  m.header = header(random);
  m.probe = index(random, 1000);
  m.pose = pose(random);
  m.twist = {vector(random), vector(random)};
  m.buttons = static_cast<std::uint32_t>(random());
}

void fill(Random& random, Contacts& m) {
  m.header = header(random);
  m.probe = index(random, 1000);
  m.probe_pose = pose(random);
  m.node_positions_sequence = random();
  m.truncated = coin(random);
  m.contacts.resize(whole(random, 0, 40));
  for (Contact& c : m.contacts) {
    const double u = real(random, 0, 0.5), v = real(random, 0, 0.5);
    c = {index(random, 1000), index(random, 1000), {u, v, 1 - u - v}, vector(random),
         unit(random),        real(random, -1, 1), real(random, 0, 1)};
  }
}

void fill(Random& random, ContactModel& m) {
  m.header = header(random);
  m.probe = index(random, 1000);
  m.touching = coin(random);
  m.anchor = vector(random);
  m.force = vector(random);
  m.torque = vector(random);
  const Vec3 a = vector(random), b = vector(random);
  m.stiffness = a * a.transpose() + b * b.transpose();
  m.normal = unit(random);
  m.friction_coefficient = real(random, 0, 2);
  m.validity_radius = real(random, 0, 1);
}

void fill(Random& random, NodePositions& m) {
  m.header = header(random);
  m.organ = index(random, 1000);
  m.generation = index(random, 1000);
  m.volume = real(random, -1, 1);
  m.target_volume = real(random, 0, 1);
  m.pressure = real(random, -1e5, 1e5);
  m.kinetic_energy = real(random, 0, 1);
  m.elastic_energy = real(random, 0, 1);
  m.positions = positions(random, whole(random, 1, 100));
}

SurfaceTopology random_topology(Random& random, std::size_t nodes, std::size_t triangles,
                                std::size_t springs) {
  SurfaceTopology m;
  m.header = header(random);
  m.organ = index(random, 1000);
  m.generation = index(random, 1000);
  m.name = text(random, 0, 30);
  m.surface_node_count = static_cast<std::uint32_t>(nodes);
  m.rest_positions = positions(random, nodes);
  const auto after = [&](std::uint32_t node, std::uint32_t steps) {
    return static_cast<std::uint32_t>((node + steps) % nodes);
  };
  for (std::size_t i = 0; i < triangles; ++i) {
    const std::uint32_t node = index(random, nodes);
    m.triangles.push_back({node, after(node, 1), after(node, 2)});
  }
  for (std::size_t i = 0; i < springs; ++i) {
    const std::uint32_t node = index(random, nodes);
    m.springs.push_back({node, after(node, 1), static_cast<SpringFamily>(index(random, 3))});
  }
  m.fixed_nodes.resize(nodes / 4);
  for (std::uint32_t& node : m.fixed_nodes) node = index(random, nodes);
  return m;
}

void fill(Random& random, SurfaceTopology& m) {
  m = random_topology(random, whole(random, 3, 50), whole(random, 0, 100), whole(random, 0, 100));
}

void fill(Random& random, HapticForce& m) {
  m.header = header(random);
  m.probe = index(random, 1000);
  m.force = vector(random);
  m.torque = vector(random);
  m.limits = index(random, 64);
  m.passivity_energy = real(random, -1, 1);
  m.contact_model_age = coin(random) ? real(random, 0, 1) : kInfinity;
}

void fill(Random& random, ModuleStatus& m) {
  m.header = header(random);
  m.module = text(random, 1, 64);
  m.state = static_cast<ModuleState>(index(random, 7));
  m.process_id = static_cast<std::int64_t>(random());
  m.rate_hz = real(random, 0, 1000);
  m.nominal_rate_hz = real(random, 0, 1000);
  m.cycles = random();
  m.overruns = random();
  m.worst_lateness = real(random, 0, 1);
  m.busy_fraction = real(random, 0, 2);
  m.real_time_factor = real(random, 0, 2);
  m.realtime_priority = coin(random);
  m.last_error = text(random, 0, 200);
  m.inputs.resize(whole(random, 0, kMaxInputs));
  for (auto& input : m.inputs) {
    input = {text(random, 1, 64), coin(random) ? real(random, 0, 1) : kInfinity, random(), random(),
             random()};
  }
}

void fill(Random& random, SceneDescription& m) {
  m.header = header(random);
  m.protocol_version = static_cast<std::uint32_t>(random());
  m.name = text(random, 0, 30);
  m.digest = text(random, 0, 64);
  m.resolved_text = text(random, 0, 5000);
}

void fill(Random& random, SessionControl& m) {
  m.header = header(random);
  m.command = static_cast<SessionCommand>(index(random, 4));
  m.reset_count = static_cast<std::uint32_t>(random());
  m.start_time_ns = static_cast<std::int64_t>(random());
}

bool equal(const ProbeState& a, const ProbeState& b) {
  return equal(a.header, b.header) && a.probe == b.probe && equal(a.pose, b.pose) &&
         a.twist.linear == b.twist.linear && a.twist.angular == b.twist.angular &&
         a.buttons == b.buttons;
}
bool equal(const Contacts& a, const Contacts& b) {
  return equal(a.header, b.header) && a.probe == b.probe && equal(a.probe_pose, b.probe_pose) &&
         a.node_positions_sequence == b.node_positions_sequence && a.truncated == b.truncated &&
         all_equal(a.contacts, b.contacts);
}
bool equal(const ContactModel& a, const ContactModel& b) {
  return equal(a.header, b.header) && a.probe == b.probe && a.touching == b.touching &&
         a.anchor == b.anchor && a.force == b.force && a.torque == b.torque &&
         a.stiffness == b.stiffness && a.normal == b.normal &&
         a.friction_coefficient == b.friction_coefficient && a.validity_radius == b.validity_radius;
}
bool equal(const NodePositions& a, const NodePositions& b) {
  return equal(a.header, b.header) && a.organ == b.organ && a.generation == b.generation &&
         a.volume == b.volume && a.target_volume == b.target_volume && a.pressure == b.pressure &&
         a.kinetic_energy == b.kinetic_energy && a.elastic_energy == b.elastic_energy &&
         a.positions == b.positions;
}
bool equal(const SurfaceTopology& a, const SurfaceTopology& b) {
  return equal(a.header, b.header) && a.organ == b.organ && a.generation == b.generation &&
         a.name == b.name && a.surface_node_count == b.surface_node_count &&
         a.rest_positions == b.rest_positions && a.triangles == b.triangles &&
         a.fixed_nodes == b.fixed_nodes && all_equal(a.springs, b.springs);
}
bool equal(const HapticForce& a, const HapticForce& b) {
  return equal(a.header, b.header) && a.probe == b.probe && a.force == b.force &&
         a.torque == b.torque && a.limits == b.limits && a.passivity_energy == b.passivity_energy &&
         a.contact_model_age == b.contact_model_age;
}
bool equal(const ModuleStatus& a, const ModuleStatus& b) {
  return equal(a.header, b.header) && a.module == b.module && a.state == b.state &&
         a.process_id == b.process_id && a.rate_hz == b.rate_hz &&
         a.nominal_rate_hz == b.nominal_rate_hz && a.cycles == b.cycles &&
         a.overruns == b.overruns && a.worst_lateness == b.worst_lateness &&
         a.busy_fraction == b.busy_fraction && a.real_time_factor == b.real_time_factor &&
         a.realtime_priority == b.realtime_priority && a.last_error == b.last_error &&
         all_equal(a.inputs, b.inputs);
}
bool equal(const SceneDescription& a, const SceneDescription& b) {
  return equal(a.header, b.header) && a.protocol_version == b.protocol_version &&
         a.name == b.name && a.digest == b.digest && a.resolved_text == b.resolved_text;
}
bool equal(const SessionControl& a, const SessionControl& b) {
  return equal(a.header, b.header) && a.command == b.command && a.reset_count == b.reset_count &&
         a.start_time_ns == b.start_time_ns;
}

}  // namespace palpate::bus::testing
