// The code that fastddsgen makes from idl/: an independent judge of our codec.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastrtps/utils/md5.h>

#include <catch2/catch.hpp>

#include "idl/ClockExchangePubSubTypes.h"
#include "idl/ContactModelPubSubTypes.h"
#include "idl/ContactsPubSubTypes.h"
#include "idl/HapticForcePubSubTypes.h"
#include "idl/ModuleStatusPubSubTypes.h"
#include "idl/NodePositionsPubSubTypes.h"
#include "idl/ProbeStatePubSubTypes.h"
#include "idl/SceneDescriptionPubSubTypes.h"
#include "idl/SessionControlPubSubTypes.h"
#include "idl/SurfaceTopologyPubSubTypes.h"
#include "tests/modules/messages/random_messages.h"

namespace palpate::messages::testing {

template <class Message>
struct Generated;
#define PALPATE_GENERATED(Message)            \
  template <>                                 \
  struct Generated<Message> {                 \
    using Wire = idl::Message;                \
    using Support = idl::Message##PubSubType; \
  };
PALPATE_MESSAGES(PALPATE_GENERATED)
#undef PALPATE_GENERATED

inline constexpr auto kLittleEndian = eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS;
inline constexpr auto kBigEndian = eprosima::fastcdr::Cdr::BIG_ENDIANNESS;

/// What the generated code reads from a payload.
template <class Message>
typename Generated<Message>::Wire generated(std::vector<std::uint8_t> payload, const Message&) {
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data()), payload.size());
  eprosima::fastcdr::Cdr cdr(buffer, kLittleEndian, eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.read_encapsulation();
  typename Generated<Message>::Wire wire;
  wire.deserialize(cdr);
  REQUIRE(cdr.getSerializedDataLength() == payload.size());
  return wire;
}

template <class Wire, class Endianness>
std::vector<std::uint8_t> serialized(const Wire& wire, Endianness endianness) {
  std::vector<std::uint8_t> payload(8 + Wire::getCdrSerializedSize(wire));
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data()), payload.size());
  eprosima::fastcdr::Cdr cdr(buffer, endianness, eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  wire.serialize(cdr);
  payload.resize(cdr.getSerializedDataLength());
  return payload;
}

// Members by names written by hand: what describe() says of neither is trusted.
inline std::array<double, 3> xyz(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline std::array<double, 4> xyzw(const Quat& q) { return {q.x(), q.y(), q.z(), q.w()}; }
inline std::array<double, 9> rows(const Mat3& k) {
  return {k(0, 0), k(0, 1), k(0, 2), k(1, 0), k(1, 1), k(1, 2), k(2, 0), k(2, 1), k(2, 2)};
}

template <class Wire, class Message>
void check_header(const Wire& w, const Message& m) {
  REQUIRE(w.sequence_number() == m.header.sequence);
  REQUIRE(w.sim_time_ns() == m.header.sim_time_ns);
  REQUIRE(w.source_time_ns() == m.header.source_time_ns);
  REQUIRE(w.session_token() == m.header.session_token);
}

inline void check_same(const idl::ProbeState& w, const ProbeState& m) {
  check_header(w, m);
  REQUIRE(w.probe() == m.probe);
  REQUIRE(w.position_m() == xyz(m.pose.position));
  REQUIRE(w.rotation_xyzw() == xyzw(m.pose.rotation));
  REQUIRE(w.linear_velocity_m_per_s() == xyz(m.twist.linear));
  REQUIRE(w.angular_velocity_rad_per_s() == xyz(m.twist.angular));
  REQUIRE(w.buttons() == m.buttons);
}

inline void check_same(const idl::Contact& w, const Contact& m) {
  REQUIRE(w.organ() == m.organ);
  REQUIRE(w.triangle() == m.triangle);
  REQUIRE(w.barycentric() == xyz(m.barycentric));
  REQUIRE(w.point_P_m() == xyz(m.point_P));
  REQUIRE(w.normal_P() == xyz(m.normal_P));
  REQUIRE(w.gap_m() == m.gap);
}

inline void check_same(const idl::FaceContacts& w, const FaceContacts& m) {
  REQUIRE(w.organ() == m.organ);
  REQUIRE(w.point_P_m() == xyz(m.point_P));
  REQUIRE(w.normal_P() == xyz(m.normal_P));
  REQUIRE(w.gap_m() == m.gap);
  REQUIRE(w.node_count() == m.node_count);
}

inline void check_same(const idl::Contacts& w, const Contacts& m) {
  check_header(w, m);
  REQUIRE(w.probe() == m.probe);
  REQUIRE(w.probe_position_m() == xyz(m.probe_pose.position));
  REQUIRE(w.probe_rotation_xyzw() == xyzw(m.probe_pose.rotation));
  REQUIRE(w.generations() == m.generations);
  REQUIRE(w.truncated() == m.truncated);
  REQUIRE(w.faces().size() == m.faces.size());
  for (std::size_t i = 0; i < m.faces.size(); ++i) check_same(w.faces()[i], m.faces[i]);
  REQUIRE(w.face_nodes() == m.face_nodes);
  REQUIRE(w.contacts().size() == m.contacts.size());
  for (std::size_t i = 0; i < m.contacts.size(); ++i) check_same(w.contacts()[i], m.contacts[i]);
}

inline void check_same(const idl::ContactModel& w, const ContactModel& m) {
  check_header(w, m);
  REQUIRE(w.probe() == m.probe);
  REQUIRE(w.process() == m.process);
  REQUIRE(w.anchor_position_m() == xyz(m.anchor.position));
  REQUIRE(w.anchor_rotation_xyzw() == xyzw(m.anchor.rotation));
  REQUIRE(w.anchor_age_s() == m.anchor_age);
  REQUIRE(w.force_error() == m.force_error);
  REQUIRE(w.period_s() == m.period);
  REQUIRE(w.growth_per_s() == m.growth);
  REQUIRE(w.friction_coefficient() == m.friction_coefficient);
  REQUIRE(w.validity_radius_m() == m.validity_radius);
  REQUIRE(w.stiffness_n_per_m() == rows(m.stiffness));
  REQUIRE(w.rows().size() == m.rows.size());
  for (std::size_t i = 0; i < m.rows.size(); ++i) {
    REQUIRE(w.rows()[i].point_P_m() == xyz(m.rows[i].point_P));
    REQUIRE(w.rows()[i].normal() == xyz(m.rows[i].normal));
    REQUIRE(w.rows()[i].gap_m() == m.rows[i].gap);
    REQUIRE(w.rows()[i].radius_m() == m.rows[i].radius);
    REQUIRE(w.rows()[i].force_n() == xyz(m.rows[i].force));
    REQUIRE(w.rows()[i].velocity_m_per_s() == xyz(m.rows[i].velocity));
  }
  REQUIRE(w.compliance_m_per_n() == m.compliance);
}

inline void check_same(const idl::NodePositions& w, const NodePositions& m) {
  check_header(w, m);
  REQUIRE(w.organ() == m.organ);
  REQUIRE(w.generation() == m.generation);
  REQUIRE(w.volume_m3() == m.volume);
  REQUIRE(w.target_volume_m3() == m.target_volume);
  REQUIRE(w.pressure_pa() == m.pressure);
  REQUIRE(w.kinetic_energy_j() == m.kinetic_energy);
  REQUIRE(w.elastic_energy_j() == m.elastic_energy);
  REQUIRE(w.organ_contacts() == m.organ_contacts);
  REQUIRE(w.positions_m() == m.positions);
  REQUIRE(w.block_boxes_m() == m.block_boxes);
}

inline void check_same(const idl::SurfaceTopology& w, const SurfaceTopology& m) {
  check_header(w, m);
  REQUIRE(w.organ() == m.organ);
  REQUIRE(w.generation() == m.generation);
  REQUIRE(w.name() == m.name);
  REQUIRE(w.surface_node_count() == m.surface_node_count);
  REQUIRE(w.rest_positions_m() == m.rest_positions);
  REQUIRE(w.triangle_blocks() == m.triangle_blocks);
  REQUIRE(w.fixed_nodes() == m.fixed_nodes);
  REQUIRE(w.triangle_nodes().size() == 3 * m.triangles.size());
  for (std::size_t i = 0; i < w.triangle_nodes().size(); ++i) {
    REQUIRE(w.triangle_nodes()[i] == m.triangles[i / 3][i % 3]);
  }
  REQUIRE(w.spring_nodes().size() == 2 * m.springs.size());
  REQUIRE(w.spring_families().size() == m.springs.size());
  for (std::size_t i = 0; i < m.springs.size(); ++i) {
    REQUIRE(w.spring_nodes()[2 * i] == m.springs[i].node_a);
    REQUIRE(w.spring_nodes()[2 * i + 1] == m.springs[i].node_b);
    REQUIRE(w.spring_families()[i] == static_cast<std::uint8_t>(m.springs[i].family));
  }
}

inline void check_same(const idl::HapticForce& w, const HapticForce& m) {
  check_header(w, m);
  REQUIRE(w.probe() == m.probe);
  REQUIRE(w.force_n() == xyz(m.force));
  REQUIRE(w.torque_n_m() == xyz(m.torque));
  REQUIRE(w.limits() == m.limits);
  REQUIRE(w.passivity_energy_j() == m.passivity_energy);
  REQUIRE(w.contact_model_age_s() == m.contact_model_age);
}

inline void check_same(const idl::InputStatus& w, const ModuleStatus::Input& m) {
  REQUIRE(w.topic() == m.topic);
  REQUIRE(w.age_s() == m.age);
  REQUIRE(w.age_error_s() == m.age_error);
  REQUIRE(w.received() == m.received);
  REQUIRE(w.dropped() == m.dropped);
  REQUIRE(w.rejected() == m.rejected);
}

inline void check_same(const idl::OrganExtremes& w, const OrganExtremes& m) {
  REQUIRE(w.organ() == m.organ);
  REQUIRE(w.volume_ratio() == m.volume_ratio);
  REQUIRE(w.worst_volume_error() == m.worst_volume_error);
  REQUIRE(w.lowest_pressure_pa() == m.lowest_pressure);
  REQUIRE(w.highest_pressure_pa() == m.highest_pressure);
  REQUIRE(w.most_contacts() == m.most_contacts);
}

inline void check_same(const idl::ProbeExtremes& w, const ProbeExtremes& m) {
  REQUIRE(w.probe() == m.probe);
  REQUIRE(w.force_n() == m.force);
  REQUIRE(w.greatest_force_n() == m.greatest_force);
  REQUIRE(w.limits() == m.limits);
  REQUIRE(w.error_of_greatest() == m.error_of_greatest);
}

inline void check_same(const idl::ModuleStatus& w, const ModuleStatus& m) {
  check_header(w, m);
  REQUIRE(w.module_name().c_str() == m.module);
  REQUIRE(static_cast<int>(w.state()) == static_cast<int>(m.state));
  REQUIRE(w.process_id() == m.process_id);
  REQUIRE(w.rate_hz() == m.rate_hz);
  REQUIRE(w.nominal_rate_hz() == m.nominal_rate_hz);
  REQUIRE(w.cycles() == m.cycles);
  REQUIRE(w.overruns() == m.overruns);
  REQUIRE(w.worst_lateness_s() == m.worst_lateness);
  REQUIRE(w.busy_fraction() == m.busy_fraction);
  REQUIRE(w.real_time_factor() == m.real_time_factor);
  REQUIRE(w.realtime_priority() == m.realtime_priority);
  REQUIRE(w.packets_refused() == m.packets_refused);
  REQUIRE(w.contacts_truncated() == m.contacts.truncated);
  REQUIRE(w.contacts_lost() == m.contacts.lost);
  REQUIRE(w.contacts_unsolved() == m.contacts.unsolved);
  REQUIRE(w.last_error() == m.last_error);
  REQUIRE(w.inputs().size() == m.inputs.size());
  for (std::size_t i = 0; i < m.inputs.size(); ++i) check_same(w.inputs()[i], m.inputs[i]);
  REQUIRE(w.organs().size() == m.organs.size());
  for (std::size_t i = 0; i < m.organs.size(); ++i) check_same(w.organs()[i], m.organs[i]);
  REQUIRE(w.probes().size() == m.probes.size());
  for (std::size_t i = 0; i < m.probes.size(); ++i) check_same(w.probes()[i], m.probes[i]);
}

inline void check_same(const idl::SceneDescription& w, const SceneDescription& m) {
  check_header(w, m);
  REQUIRE(w.protocol_version() == m.protocol_version);
  REQUIRE(w.name() == m.name);
  REQUIRE(w.digest() == m.digest);
  REQUIRE(w.resolved_text() == m.resolved_text);
}

inline void check_same(const idl::SessionControl& w, const SessionControl& m) {
  check_header(w, m);
  REQUIRE(static_cast<int>(w.command()) == static_cast<int>(m.command));
  REQUIRE(w.reset_count() == m.reset_count);
  REQUIRE(w.start_time_ns() == m.start_time_ns);
  REQUIRE(w.until_ns() == m.until_ns);
}

inline void check_same(const idl::ClockEcho& w, const ClockExchange::Echo& m) {
  REQUIRE(w.process() == m.process);
  REQUIRE(w.sent_ns() == m.sent_ns);
  REQUIRE(w.received_ns() == m.received_ns);
}

inline void check_same(const idl::ClockExchange& w, const ClockExchange& m) {
  check_header(w, m);
  REQUIRE(w.process() == m.process);
  REQUIRE(w.echoes().size() == m.echoes.size());
  for (std::size_t i = 0; i < m.echoes.size(); ++i) check_same(w.echoes()[i], m.echoes[i]);
}

/// Our key's bytes are what the generated code copies or hashes.
template <class Message>
void check_keys() {
  CAPTURE(type_of<Message>().name);
  Random random(15);
  typename Generated<Message>::Support support;
  const MessageType& type = type_of<Message>();
  REQUIRE(support.m_isGetKeyDefined == (type.key != MessageType::Key::kNone));
  REQUIRE(support.getName() == type.wire_name);
  for (int round = 0; round < 50 && support.m_isGetKeyDefined; ++round) {
    const auto message = random_message<Message>(random);
    const auto payload = payload_of(message);
    auto wire = generated(payload, message);
    const KeyBytes key = key_of(type, payload);
    REQUIRE(key.readable);
    REQUIRE(key_of(type, serialized(wire, kBigEndian)) == key);
    eprosima::fastrtps::rtps::InstanceHandle_t handle;
    REQUIRE(support.getKey(&wire, &handle, true));
    MD5 md5;
    md5.init();
    md5.update(key.bytes.data(), static_cast<unsigned>(key.size));
    md5.finalize();
    for (std::size_t i = 0; i < 16; ++i) REQUIRE(handle.value[i] == md5.digest[i]);
    if (type.key == MessageType::Key::kText) continue;
    REQUIRE(support.getKey(&wire, &handle, false));
    for (std::size_t i = 0; i < 16; ++i) REQUIRE(handle.value[i] == key.bytes[i]);
  }
}

}  // namespace palpate::messages::testing
