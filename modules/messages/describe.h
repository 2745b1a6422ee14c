// The messages, described once: every field in its order on the wire (idl/), with its rule.
//
// describe(visitor, message) names each field together with the member that holds it. Visitors walk
// it: CdrWriter and CdrReader (cdr.cpp), Checker (message_checks.cpp), the columns of CSV files
// (csv.cpp), random messages (tests). A visitor offers
//   header(h)                               walks describe(visitor, h), or leaves it out
//   key(name, field)                        the key: a number or a text, right after the header
//   field(name, field, rule)                a number, vector, rotation, matrix, text, word or flag
//   numbers(name, list, bounds)             numbers that lie in memory as they travel: in one piece
//   numbers(name, list, bounds, parts)      those that `parts` points to in each entry of the list
//   list(name, list, max)                   entries that are described themselves
//   derived(name, compute)                  no field: a number that tables show
//   require(name, holds)                    a rule across fields; `name` is to blame
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <limits>
#include <span>

#include "modules/messages/messages.h"

namespace palpate::messages {

/// Allowed asymmetry of a stiffness, relative to its largest entry.
inline constexpr double kStiffnessTolerance = 1e-6;
inline constexpr std::size_t kMaxNameBytes = 64;  ///< of a module and a topic

/// What a field must satisfy beside its type. Whatever the rule, floating-point numbers are finite
/// and at most kMaxMagnitude (but kAge), counts at most kMaxCount (but kToken), times within
/// kMaxTimeNs, words are listed ones and texts hold at most kMaxTextBytes and no zero byte.
enum class Rule {
  kPlain,
  kToken,        ///< any 64 bits
  kFromOne,      ///< ≥ 1
  kAtLeastZero,  ///< ≥ 0
  kSinceSetUp,   ///< ≥ −1: what is said before the first lockstep cycle has −1
  kAge,          ///< ≥ 0; infinity: nothing came yet
  kUnit,         ///< length 1 within kUnitTolerance
  kWeights,      ///< ≥ 0, sum 1, both within kUnitTolerance
  kSymmetric,    ///< within kStiffnessTolerance
  kForceLimits,  ///< only bits of ForceLimit
  kName,         ///< 1 to kMaxNameBytes bytes
  kDocument,     ///< a text too long for tables
};

/// Length of a list of numbers that travels flat.
struct Bounds {
  std::size_t numbers_per_entry = 1;
  std::size_t min_entries = 0, max_entries = 0;
  const char* count_name = nullptr;  ///< of the number of entries in tables; nullptr: not shown
};

/// The words for the values of an enumeration, in its order from 0.
template <class Enum>
struct Words;
template <>
struct Words<ModuleState> {
  static constexpr std::array texts{"starting", "ready", "running", "paused",
                                    "degraded", "fault", "stopped"};
};
template <>
struct Words<SessionCommand> {
  static constexpr std::array texts{"start", "pause", "reset", "stop", "step"};
};
template <>
struct Words<SpringFamily> {
  static constexpr std::array texts{"structural", "bending", "inner"};
};
template <class Enum>
constexpr bool is_word(Enum value) {
  return static_cast<std::size_t>(value) < Words<Enum>::texts.size();
}
/// "unknown" for a value that is none.
template <class Enum>
constexpr const char* word_of(Enum value) {
  return is_word(value) ? Words<Enum>::texts[static_cast<std::size_t>(value)] : "unknown";
}

/// Whether every number from 0 to the greatest is there.
inline bool counts_without_gaps(const std::vector<std::uint32_t>& numbers) {
  std::vector<bool> seen(numbers.size(), false);
  std::size_t greatest = 0, different = 0;
  for (const std::uint32_t number : numbers) {
    if (number >= seen.size()) return false;
    greatest = std::max<std::size_t>(greatest, number);
    if (!seen[number]) ++different;
    seen[number] = true;
  }
  return numbers.empty() || different == greatest + 1;
}

/// Whether in each run of six numbers none of the first three is greater than its like of the last.
inline bool are_boxes(std::span<const float> numbers) {
  for (; numbers.size() >= 6; numbers = numbers.subspan(6)) {
    if (numbers[0] > numbers[3] || numbers[1] > numbers[4] || numbers[2] > numbers[5]) return false;
  }
  return true;
}

/// A T, constant or not.
template <class M, class T>
concept Is = std::same_as<std::remove_const_t<M>, T>;
template <class T>
concept Enumeration = std::is_enum_v<T>;
template <class T>
concept Composed = Is<T, Vec3> || Is<T, Quat> || Is<T, Mat3>;

/// Calls f with each number in its order on the wire: x, y, z, w; matrices row by row.
template <Composed T, class F>
void for_each_number(T& value, F&& f) {
  if constexpr (Is<T, Mat3>) {
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 3; ++column) f(value(row, column));
    }
  } else if constexpr (Is<T, Quat>) {
    for (Eigen::Index i = 0; i < 4; ++i) f(value.coeffs()[i]);  // Eigen keeps x, y, z, w
  } else {
    for (Eigen::Index i = 0; i < 3; ++i) f(value[i]);
  }
}

template <class V, Is<Header> H>
void describe(V& v, H& h) {
  v.field("sequence_number", h.sequence, Rule::kFromOne);
  v.field("sim_time_ns", h.sim_time_ns, Rule::kPlain);
  v.field("source_time_ns", h.source_time_ns, Rule::kSinceSetUp);
  v.field("session_token", h.session_token, Rule::kToken);
}

template <class V, Is<ProbeState> M>
void describe(V& v, M& m) {
  v.header(m.header);
  v.key("probe", m.probe);
  v.field("position_m", m.pose.position, Rule::kPlain);
  v.field("rotation_xyzw", m.pose.rotation, Rule::kUnit);
  v.field("linear_velocity_m_per_s", m.twist.linear, Rule::kPlain);
  v.field("angular_velocity_rad_per_s", m.twist.angular, Rule::kPlain);
  v.field("buttons", m.buttons, Rule::kPlain);
}

template <class V, Is<Contact> C>
void describe(V& v, C& c) {
  v.field("contacts.organ", c.organ, Rule::kPlain);
  v.field("contacts.triangle", c.triangle, Rule::kPlain);
  v.field("contacts.barycentric", c.barycentric, Rule::kWeights);
  v.field("contacts.point_P_m", c.point_P, Rule::kPlain);
  v.field("contacts.normal_P", c.normal_P, Rule::kUnit);
  v.field("contacts.gap_m", c.gap, Rule::kPlain);
}

template <class V, Is<FaceContacts> F>
void describe(V& v, F& f) {
  v.field("faces.organ", f.organ, Rule::kPlain);
  v.field("faces.point_P_m", f.point_P, Rule::kPlain);
  v.field("faces.normal_P", f.normal_P, Rule::kUnit);
  v.field("faces.gap_m", f.gap, Rule::kPlain);
  v.field("faces.node_count", f.node_count, Rule::kFromOne);
}

template <class V, Is<Contacts> M>
void describe(V& v, M& m) {
  v.header(m.header);
  v.key("probe", m.probe);
  v.field("probe_position_m", m.probe_pose.position, Rule::kPlain);
  v.field("probe_rotation_xyzw", m.probe_pose.rotation, Rule::kUnit);
  v.numbers("generations", m.generations, Bounds{1, 0, kMaxOrgans, "organ_count"});
  v.field("truncated", m.truncated, Rule::kPlain);
  v.list("faces", m.faces, kMaxFacesPerProbe, "face_count");
  v.numbers("face_nodes", m.face_nodes, Bounds{1, 0, kMaxFaceNodes, "face_node_count"});
  v.list("contacts", m.contacts, kMaxContactsPerProbe, "contact_count");
  v.derived("deepest_gap_m", [&] { return m.deepest_gap(); });
  v.require("face_nodes", [&] {
    std::size_t nodes = 0;
    for (const FaceContacts& face : m.faces) nodes += face.node_count;
    return nodes == m.face_nodes.size();
  });
}

template <class V, Is<LawRow> R>
void describe(V& v, R& r) {
  v.field("rows.point_P_m", r.point_P, Rule::kPlain);
  v.field("rows.normal", r.normal, Rule::kUnit);
  v.field("rows.gap_m", r.gap, Rule::kAtLeastZero);
  v.field("rows.radius_m", r.radius, Rule::kAtLeastZero);
  v.field("rows.force_n", r.force, Rule::kPlain);
  v.field("rows.velocity_m_per_s", r.velocity, Rule::kPlain);
}

template <class V, Is<ContactModel> M>
void describe(V& v, M& m) {
  v.header(m.header);
  v.key("probe", m.probe);
  v.key("process", m.process);
  v.field("anchor_position_m", m.anchor.position, Rule::kPlain);
  v.field("anchor_rotation_xyzw", m.anchor.rotation, Rule::kUnit);
  v.field("anchor_age_s", m.anchor_age, Rule::kAtLeastZero);
  v.field("period_s", m.period, Rule::kAtLeastZero);
  v.field("growth_per_s", m.growth, Rule::kPlain);
  v.field("friction_coefficient", m.friction_coefficient, Rule::kAtLeastZero);
  v.field("validity_radius_m", m.validity_radius, Rule::kAtLeastZero);
  v.field("stiffness_n_per_m", m.stiffness, Rule::kSymmetric);
  v.field("force_error", m.force_error, Rule::kAtLeastZero);
  v.list("rows", m.rows, kMaxLawRows, "row_count");
  v.numbers("compliance_m_per_n", m.compliance, Bounds{1, 0, kMaxLawCompliance, nullptr});
  v.derived("force_n", [&] { return m.force().norm(); });
  v.require("compliance_m_per_n", [&] {
    const std::size_t size = m.directions() * m.rows.size();
    return m.compliance.size() == size * (size + 1) / 2;
  });
}

template <class V, Is<NodePositions> M>
void describe(V& v, M& m) {
  v.header(m.header);
  v.key("organ", m.organ);
  v.field("generation", m.generation, Rule::kPlain);
  v.field("volume_m3", m.volume, Rule::kPlain);
  v.field("target_volume_m3", m.target_volume, Rule::kAtLeastZero);
  v.field("pressure_pa", m.pressure, Rule::kPlain);
  v.field("kinetic_energy_j", m.kinetic_energy, Rule::kAtLeastZero);
  v.field("elastic_energy_j", m.elastic_energy, Rule::kAtLeastZero);
  v.field("organ_contacts", m.organ_contacts, Rule::kPlain);
  v.numbers("block_boxes_m", m.block_boxes, Bounds{6, 0, kMaxTriangles, nullptr});
  v.numbers("positions_m", m.positions, Bounds{3, 1, kMaxNodes, "node_count"});
  v.require("block_boxes_m", [&] { return are_boxes(m.block_boxes); });
}

template <class V, Is<SurfaceTopology> M>
void describe(V& v, M& m) {
  v.header(m.header);
  v.key("organ", m.organ);
  v.field("generation", m.generation, Rule::kPlain);
  v.field("name", m.name, Rule::kPlain);
  v.field("surface_node_count", m.surface_node_count, Rule::kPlain);
  v.numbers("rest_positions_m", m.rest_positions, Bounds{3, 1, kMaxNodes, "node_count"});
  v.numbers("triangle_nodes", m.triangles, Bounds{3, 0, kMaxTriangles, "triangle_count"});
  v.numbers("triangle_blocks", m.triangle_blocks, Bounds{1, 0, kMaxTriangles, nullptr});
  v.numbers("fixed_nodes", m.fixed_nodes, Bounds{1, 0, kMaxNodes, "fixed_count"});
  v.numbers("spring_nodes", m.springs, Bounds{2, 0, kMaxSprings, "spring_count"}, [](auto& spring) {
    return std::array{&spring.node_a, &spring.node_b};
  });
  v.numbers("spring_families", m.springs, Bounds{1, m.springs.size(), m.springs.size()},
            [](auto& spring) { return std::array{&spring.family}; });

  const auto nodes = [&m] { return m.rest_positions.size() / 3; };
  v.require("surface_node_count", [&] { return m.surface_node_count <= nodes(); });
  v.require("triangle_nodes", [&] {
    return std::ranges::all_of(m.triangles, [&](const auto& t) {
      return t[0] != t[1] && t[1] != t[2] && t[2] != t[0] &&
             std::max({t[0], t[1], t[2]}) < m.surface_node_count;
    });
  });
  v.require("triangle_blocks", [&] {
    const auto& blocks = m.triangle_blocks;
    return blocks.empty() || (blocks.size() == m.triangles.size() && counts_without_gaps(blocks));
  });
  v.require("fixed_nodes", [&] {
    return m.fixed_nodes.size() <= nodes() &&
           std::ranges::all_of(m.fixed_nodes, [&](std::uint32_t node) { return node < nodes(); });
  });
  v.require("spring_nodes", [&] {
    return std::ranges::all_of(m.springs, [&](const SurfaceTopology::Spring& s) {
      return s.node_a != s.node_b && std::max(s.node_a, s.node_b) < nodes();
    });
  });
}

template <class V, Is<HapticForce> M>
void describe(V& v, M& m) {
  v.header(m.header);
  v.key("probe", m.probe);
  v.field("force_n", m.force, Rule::kPlain);
  v.field("torque_n_m", m.torque, Rule::kPlain);
  v.field("limits", m.limits, Rule::kForceLimits);
  v.field("passivity_energy_j", m.passivity_energy, Rule::kPlain);
  v.field("contact_model_age_s", m.contact_model_age, Rule::kAge);
}

template <class V, Is<ModuleStatus::Input> I>
void describe(V& v, I& input) {
  v.field("inputs.topic", input.topic, Rule::kName);
  v.field("inputs.age_s", input.age, Rule::kAge);
  v.field("inputs.age_error_s", input.age_error, Rule::kAtLeastZero);
  v.field("inputs.received", input.received, Rule::kPlain);
  v.field("inputs.dropped", input.dropped, Rule::kPlain);
  v.field("inputs.rejected", input.rejected, Rule::kPlain);
}

template <class V, Is<OrganExtremes> O>
void describe(V& v, O& organ) {
  v.field("organs.organ", organ.organ, Rule::kPlain);
  v.field("organs.volume_ratio", organ.volume_ratio, Rule::kPlain);
  v.field("organs.worst_volume_error", organ.worst_volume_error, Rule::kAtLeastZero);
  v.field("organs.lowest_pressure_pa", organ.lowest_pressure, Rule::kPlain);
  v.field("organs.highest_pressure_pa", organ.highest_pressure, Rule::kPlain);
  v.field("organs.most_contacts", organ.most_contacts, Rule::kPlain);
}

template <class V, Is<ProbeExtremes> P>
void describe(V& v, P& probe) {
  v.field("probes.probe", probe.probe, Rule::kPlain);
  v.field("probes.force_n", probe.force, Rule::kAtLeastZero);
  v.field("probes.greatest_force_n", probe.greatest_force, Rule::kAtLeastZero);
  v.field("probes.limits", probe.limits, Rule::kForceLimits);
  v.field("probes.error_of_greatest", probe.error_of_greatest, Rule::kAtLeastZero);
}

template <class V, Is<ModuleStatus> M>
void describe(V& v, M& m) {
  v.header(m.header);
  v.key("module_name", m.module);
  v.field("state", m.state, Rule::kPlain);
  v.field("process_id", m.process_id, Rule::kPlain);
  v.field("rate_hz", m.rate_hz, Rule::kAtLeastZero);
  v.field("nominal_rate_hz", m.nominal_rate_hz, Rule::kAtLeastZero);
  v.field("cycles", m.cycles, Rule::kPlain);
  v.field("overruns", m.overruns, Rule::kPlain);
  v.field("worst_lateness_s", m.worst_lateness, Rule::kAtLeastZero);
  v.field("busy_fraction", m.busy_fraction, Rule::kAtLeastZero);
  v.field("real_time_factor", m.real_time_factor, Rule::kAtLeastZero);
  v.field("realtime_priority", m.realtime_priority, Rule::kPlain);
  v.field("packets_refused", m.packets_refused, Rule::kPlain);
  v.field("contacts_truncated", m.contacts.truncated, Rule::kPlain);
  v.field("contacts_lost", m.contacts.lost, Rule::kPlain);
  v.field("contacts_unsolved", m.contacts.unsolved, Rule::kPlain);
  v.field("last_error", m.last_error, Rule::kPlain);
  v.list("inputs", m.inputs, kMaxInputs, nullptr);
  v.list("organs", m.organs, kMaxOrgans, nullptr);
  v.list("probes", m.probes, kMaxProbes, nullptr);
}

template <class V, Is<SceneDescription> M>
void describe(V& v, M& m) {
  v.header(m.header);
  v.field("protocol_version", m.protocol_version, Rule::kPlain);
  v.field("name", m.name, Rule::kPlain);
  v.field("digest", m.digest, Rule::kPlain);
  v.field("resolved_text", m.resolved_text, Rule::kDocument);
}

template <class V, Is<SessionControl> M>
void describe(V& v, M& m) {
  v.header(m.header);
  v.field("command", m.command, Rule::kPlain);
  v.field("reset_count", m.reset_count, Rule::kPlain);
  v.field("start_time_ns", m.start_time_ns, Rule::kPlain);
  v.field("until_ns", m.until_ns, Rule::kPlain);
}

template <class V, Is<ClockExchange::Echo> E>
void describe(V& v, E& echo) {
  v.field("echoes.process", echo.process, Rule::kPlain);
  v.field("echoes.sent_ns", echo.sent_ns, Rule::kPlain);
  v.field("echoes.received_ns", echo.received_ns, Rule::kPlain);
}

template <class V, Is<ClockExchange> M>
void describe(V& v, M& m) {
  v.header(m.header);
  v.field("process", m.process, Rule::kPlain);
  v.list("echoes", m.echoes, kMaxClockEchoes, "echo_count");
}

}  // namespace palpate::messages
