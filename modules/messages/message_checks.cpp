#include "modules/messages/message_checks.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate::bus {
namespace {

bool finite(const Vec3& v) { return v.allFinite(); }
bool finite(double x) { return std::isfinite(x); }
bool at_least_zero(double x) { return std::isfinite(x) && x >= 0; }
bool age(double seconds) { return seconds >= 0; }  // infinity: nothing came yet
bool unit(const Vec3& v) { return std::abs(v.norm() - 1) <= kUnitTolerance; }
bool unit(const Quat& q) { return std::abs(q.norm() - 1) <= kUnitTolerance; }

// A zero byte would end the text on the wire.
bool text(const std::string& s, std::size_t max_bytes) {
  return s.size() <= max_bytes && s.find('\0') == std::string::npos;
}
bool name(const std::string& s) { return !s.empty() && text(s, kMaxNameBytes); }

bool barycentric(const Vec3& weights) {
  return finite(weights) && weights.minCoeff() >= -kUnitTolerance &&
         std::abs(weights.sum() - 1) <= kUnitTolerance;
}

// By the exponent's bits: unlike std::isfinite in a search, this loop vectorizes.
bool all_finite(const std::vector<float>& values) {
  constexpr std::uint32_t kExponent = 0x7f800000;
  std::uint32_t not_finite = 0;
  for (const float x : values) {
    not_finite |= (std::bit_cast<std::uint32_t>(x) & kExponent) == kExponent ? 1u : 0u;
  }
  return not_finite == 0;
}

bool positions(const std::vector<float>& xyz) {
  const std::size_t nodes = xyz.size() / 3;
  return xyz.size() % 3 == 0 && nodes >= 1 && nodes <= kMaxNodes && all_finite(xyz);
}

bool positive_semidefinite(const Mat3& k) {
  if (!k.allFinite()) return false;
  const double tolerance = kStiffnessTolerance * k.cwiseAbs().maxCoeff();
  if ((k - k.transpose()).cwiseAbs().maxCoeff() > tolerance) return false;
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(k, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() >= -tolerance;
}

const char* invalid_header(const Header& header) {
  if (header.sequence == 0) return "sequence_number";
  if (header.source_time_ns < 0) return "source_time_ns";
  return nullptr;
}

const char* invalid_contact(const Contact& c) {
  if (!barycentric(c.barycentric)) return "contacts.barycentric";
  if (!finite(c.point_on_probe)) return "contacts.point_on_probe_m";
  if (!unit(c.normal)) return "contacts.normal";
  if (!finite(c.gap)) return "contacts.gap_m";
  if (!(c.time_of_impact >= 0 && c.time_of_impact <= 1)) return "contacts.time_of_impact";
  return nullptr;
}

bool triangles(const SurfaceTopology& m) {
  return m.triangles.size() <= kMaxTriangles &&
         std::all_of(m.triangles.begin(), m.triangles.end(), [&](const auto& t) {
           return t[0] != t[1] && t[1] != t[2] && t[2] != t[0] &&
                  std::max({t[0], t[1], t[2]}) < m.surface_node_count;
         });
}

bool springs(const SurfaceTopology& m, std::size_t node_count) {
  return m.springs.size() <= kMaxSprings &&
         std::all_of(m.springs.begin(), m.springs.end(), [&](const auto& s) {
           return s.node_a != s.node_b && std::max(s.node_a, s.node_b) < node_count;
         });
}

bool spring_families(const SurfaceTopology& m) {
  return std::all_of(m.springs.begin(), m.springs.end(),
                     [](const auto& s) { return s.family <= SpringFamily::kInner; });
}

bool inputs(const ModuleStatus& m) {
  return m.inputs.size() <= kMaxInputs &&
         std::all_of(m.inputs.begin(), m.inputs.end(),
                     [](const auto& input) { return name(input.topic) && age(input.age); });
}

}  // namespace

const char* first_invalid_field(const ProbeState& m) {
  if (const char* field = invalid_header(m.header)) return field;
  if (!finite(m.pose.position)) return "position_m";
  if (!unit(m.pose.rotation)) return "rotation_xyzw";
  if (!finite(m.twist.linear)) return "linear_velocity_m_per_s";
  if (!finite(m.twist.angular)) return "angular_velocity_rad_per_s";
  return nullptr;
}

const char* first_invalid_field(const Contacts& m) {
  if (const char* field = invalid_header(m.header)) return field;
  if (!finite(m.probe_pose.position)) return "probe_position_m";
  if (!unit(m.probe_pose.rotation)) return "probe_rotation_xyzw";
  if (m.contacts.size() > kMaxContactsPerProbe) return "contacts";
  for (const Contact& contact : m.contacts) {
    if (const char* field = invalid_contact(contact)) return field;
  }
  return nullptr;
}

const char* first_invalid_field(const ContactModel& m) {
  if (const char* field = invalid_header(m.header)) return field;
  if (!finite(m.anchor)) return "anchor_m";
  if (!finite(m.force)) return "force_n";
  if (!finite(m.torque)) return "torque_n_m";
  if (!positive_semidefinite(m.stiffness)) return "stiffness_n_per_m";
  if (!unit(m.normal)) return "normal";
  if (!at_least_zero(m.friction_coefficient)) return "friction_coefficient";
  if (!at_least_zero(m.validity_radius)) return "validity_radius_m";
  return nullptr;
}

const char* first_invalid_field(const NodePositions& m) {
  if (const char* field = invalid_header(m.header)) return field;
  if (!finite(m.volume)) return "volume_m3";
  if (!at_least_zero(m.target_volume)) return "target_volume_m3";
  if (!finite(m.pressure)) return "pressure_pa";
  if (!at_least_zero(m.kinetic_energy)) return "kinetic_energy_j";
  if (!at_least_zero(m.elastic_energy)) return "elastic_energy_j";
  if (!positions(m.positions)) return "positions_m";
  return nullptr;
}

const char* first_invalid_field(const SurfaceTopology& m) {
  if (const char* field = invalid_header(m.header)) return field;
  if (!text(m.name, kMaxTextBytes)) return "name";
  if (!positions(m.rest_positions)) return "rest_positions_m";
  const std::size_t node_count = m.rest_positions.size() / 3;
  if (m.surface_node_count > node_count) return "surface_node_count";
  if (!triangles(m)) return "triangle_nodes";
  const bool fixed_exist = std::all_of(m.fixed_nodes.begin(), m.fixed_nodes.end(),
                                       [&](std::uint32_t node) { return node < node_count; });
  if (!fixed_exist || m.fixed_nodes.size() > node_count) return "fixed_nodes";
  if (!springs(m, node_count)) return "spring_nodes";
  if (!spring_families(m)) return "spring_families";
  return nullptr;
}

const char* first_invalid_field(const HapticForce& m) {
  constexpr std::uint32_t kKnownLimits = 2 * kForceOutOfValidity - 1;
  if (const char* field = invalid_header(m.header)) return field;
  if (!finite(m.force)) return "force_n";
  if (!finite(m.torque)) return "torque_n_m";
  if ((m.limits & ~kKnownLimits) != 0) return "limits";
  if (!finite(m.passivity_energy)) return "passivity_energy_j";
  if (!age(m.contact_model_age)) return "contact_model_age_s";
  return nullptr;
}

const char* first_invalid_field(const ModuleStatus& m) {
  if (const char* field = invalid_header(m.header)) return field;
  if (!name(m.module)) return "module_name";
  if (m.state > ModuleState::kStopped) return "state";
  if (!at_least_zero(m.rate_hz)) return "rate_hz";
  if (!at_least_zero(m.nominal_rate_hz)) return "nominal_rate_hz";
  if (!at_least_zero(m.worst_lateness)) return "worst_lateness_s";
  if (!at_least_zero(m.busy_fraction)) return "busy_fraction";
  if (!at_least_zero(m.real_time_factor)) return "real_time_factor";
  if (!text(m.last_error, kMaxTextBytes)) return "last_error";
  if (!inputs(m)) return "inputs";
  return nullptr;
}

const char* first_invalid_field(const SceneDescription& m) {
  if (const char* field = invalid_header(m.header)) return field;
  if (!text(m.name, kMaxTextBytes)) return "name";
  if (!text(m.digest, kMaxTextBytes)) return "digest";
  if (!text(m.resolved_text, kMaxTextBytes)) return "resolved_text";
  return nullptr;
}

const char* first_invalid_field(const SessionControl& m) {
  if (const char* field = invalid_header(m.header)) return field;
  if (m.command > SessionCommand::kStop) return "command";
  return nullptr;
}

}  // namespace palpate::bus
