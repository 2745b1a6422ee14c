// Codecs of what is sent per probe, thousands of times a second.
#include "idl/ContactModel.h"
#include "idl/Contacts.h"
#include "idl/HapticForce.h"
#include "idl/ProbeState.h"
#include "modules/bus/codec.h"
#include "modules/bus/codec_fields.h"
#include "modules/messages/message_checks.h"

namespace palpate::bus {
namespace {

void encode_contact(const Contact& contact, idl::Contact& wire) {
  wire.organ(contact.organ);
  wire.triangle(contact.triangle);
  wire.barycentric(to_array(contact.barycentric));
  wire.point_on_probe_m(to_array(contact.point_on_probe));
  wire.normal(to_array(contact.normal));
  wire.gap_m(contact.gap);
  wire.time_of_impact(contact.time_of_impact);
}

Contact decode_contact(const idl::Contact& wire) {
  return {.organ = wire.organ(),
          .triangle = wire.triangle(),
          .barycentric = to_vec3(wire.barycentric()),
          .point_on_probe = to_vec3(wire.point_on_probe_m()),
          .normal = to_vec3(wire.normal()),
          .gap = wire.gap_m(),
          .time_of_impact = wire.time_of_impact()};
}

}  // namespace

const char* encode(const ProbeState& message, idl::ProbeState& wire) {
  if (const char* field = first_invalid_field(message)) return field;
  encode_header(message.header, wire);
  wire.probe(message.probe);
  wire.position_m(to_array(message.pose.position));
  wire.rotation_xyzw(to_xyzw(message.pose.rotation));
  wire.linear_velocity_m_per_s(to_array(message.twist.linear));
  wire.angular_velocity_rad_per_s(to_array(message.twist.angular));
  wire.buttons(message.buttons);
  return nullptr;
}

const char* decode(const idl::ProbeState& wire, ProbeState& message) {
  message.header = decode_header(wire);
  message.probe = wire.probe();
  message.pose = {to_vec3(wire.position_m()), to_quat(wire.rotation_xyzw())};
  message.twist = {to_vec3(wire.linear_velocity_m_per_s()),
                   to_vec3(wire.angular_velocity_rad_per_s())};
  message.buttons = wire.buttons();
  return first_invalid_field(message);
}

const char* encode(const Contacts& message, idl::Contacts& wire) {
  if (const char* field = first_invalid_field(message)) return field;
  encode_header(message.header, wire);
  wire.probe(message.probe);
  wire.probe_position_m(to_array(message.probe_pose.position));
  wire.probe_rotation_xyzw(to_xyzw(message.probe_pose.rotation));
  wire.node_positions_sequence(message.node_positions_sequence);
  wire.truncated(message.truncated);
  wire.contacts().resize(message.contacts.size());
  for (std::size_t i = 0; i < message.contacts.size(); ++i) {
    encode_contact(message.contacts[i], wire.contacts()[i]);
  }
  return nullptr;
}

const char* decode(const idl::Contacts& wire, Contacts& message) {
  if (wire.contacts().size() > kMaxContactsPerProbe) return "contacts";
  message.header = decode_header(wire);
  message.probe = wire.probe();
  message.probe_pose = {to_vec3(wire.probe_position_m()), to_quat(wire.probe_rotation_xyzw())};
  message.node_positions_sequence = wire.node_positions_sequence();
  message.truncated = wire.truncated();
  message.contacts.clear();
  for (const idl::Contact& contact : wire.contacts()) {
    message.contacts.push_back(decode_contact(contact));
  }
  return first_invalid_field(message);
}

const char* encode(const ContactModel& message, idl::ContactModel& wire) {
  if (const char* field = first_invalid_field(message)) return field;
  encode_header(message.header, wire);
  wire.probe(message.probe);
  wire.touching(message.touching);
  wire.anchor_m(to_array(message.anchor));
  wire.force_n(to_array(message.force));
  wire.torque_n_m(to_array(message.torque));
  for (int i = 0; i < 9; ++i) wire.stiffness_n_per_m()[i] = message.stiffness(i / 3, i % 3);
  wire.normal(to_array(message.normal));
  wire.friction_coefficient(message.friction_coefficient);
  wire.validity_radius_m(message.validity_radius);
  return nullptr;
}

const char* decode(const idl::ContactModel& wire, ContactModel& message) {
  message.header = decode_header(wire);
  message.probe = wire.probe();
  message.touching = wire.touching();
  message.anchor = to_vec3(wire.anchor_m());
  message.force = to_vec3(wire.force_n());
  message.torque = to_vec3(wire.torque_n_m());
  for (int i = 0; i < 9; ++i) message.stiffness(i / 3, i % 3) = wire.stiffness_n_per_m()[i];
  message.normal = to_vec3(wire.normal());
  message.friction_coefficient = wire.friction_coefficient();
  message.validity_radius = wire.validity_radius_m();
  return first_invalid_field(message);
}

const char* encode(const HapticForce& message, idl::HapticForce& wire) {
  if (const char* field = first_invalid_field(message)) return field;
  encode_header(message.header, wire);
  wire.probe(message.probe);
  wire.force_n(to_array(message.force));
  wire.torque_n_m(to_array(message.torque));
  wire.limits(message.limits);
  wire.passivity_energy_j(message.passivity_energy);
  wire.contact_model_age_s(message.contact_model_age);
  return nullptr;
}

const char* decode(const idl::HapticForce& wire, HapticForce& message) {
  message.header = decode_header(wire);
  message.probe = wire.probe();
  message.force = to_vec3(wire.force_n());
  message.torque = to_vec3(wire.torque_n_m());
  message.limits = wire.limits();
  message.passivity_energy = wire.passivity_energy_j();
  message.contact_model_age = wire.contact_model_age_s();
  return first_invalid_field(message);
}

}  // namespace palpate::bus
