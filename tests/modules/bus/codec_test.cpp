#include "modules/bus/codec.h"

#include <catch2/catch.hpp>
#include <functional>

#include "idl/ContactModel.h"
#include "idl/Contacts.h"
#include "idl/HapticForce.h"
#include "idl/ModuleStatus.h"
#include "idl/NodePositions.h"
#include "idl/ProbeState.h"
#include "idl/SceneDescription.h"
#include "idl/SessionControl.h"
#include "idl/SurfaceTopology.h"
#include "modules/messages/message_checks.h"
#include "tests/modules/bus/random_messages.h"

namespace palpate::bus {
namespace {

using testing::Random;
using testing::random_message;

constexpr int kRounds = 200;

// The same wire object and target serve every round, so leftovers of the last would show.
template <class Message, class Wire>
void check_round_trip() {
  Random random(11);
  Wire wire;
  Message decoded;
  for (int round = 0; round < kRounds; ++round) {
    const Message message = random_message<Message>(random);
    REQUIRE(encode(message, wire) == nullptr);
    REQUIRE(decode(wire, decoded) == nullptr);
    REQUIRE(testing::equal(message, decoded));
  }
}

// Spoils an encoded random message and returns the field that decode names.
template <class Message, class Wire>
std::string rejected(const std::function<void(Wire&)>& spoil) {
  Random random(12);
  Wire wire;
  REQUIRE(encode(random_message<Message>(random), wire) == nullptr);
  spoil(wire);
  Message decoded;
  const char* field = decode(wire, decoded);
  return field == nullptr ? "accepted" : field;
}

std::string rejected_topology(const std::function<void(idl::SurfaceTopology&)>& spoil) {
  return rejected<SurfaceTopology, idl::SurfaceTopology>(spoil);
}
std::string rejected_status(const std::function<void(idl::ModuleStatus&)>& spoil) {
  return rejected<ModuleStatus, idl::ModuleStatus>(spoil);
}

}  // namespace

TEST_CASE("codec: decoding what was encoded gives the same message, bit by bit", "[bus]") {
  // Oracle: identity, for random messages of every type.
  check_round_trip<ProbeState, idl::ProbeState>();
  check_round_trip<Contacts, idl::Contacts>();
  check_round_trip<ContactModel, idl::ContactModel>();
  check_round_trip<NodePositions, idl::NodePositions>();
  check_round_trip<SurfaceTopology, idl::SurfaceTopology>();
  check_round_trip<HapticForce, idl::HapticForce>();
  check_round_trip<ModuleStatus, idl::ModuleStatus>();
  check_round_trip<SceneDescription, idl::SceneDescription>();
  check_round_trip<SessionControl, idl::SessionControl>();
}

TEST_CASE("codec: quaternions go x, y, z, w and matrices row by row", "[bus]") {
  // Oracle: the wire specification (idl/).
  ProbeState state;
  state.header.sequence = 1;
  state.pose.rotation = Quat(0.5, -0.5, 0.5, -0.5);  // w first
  idl::ProbeState wire_state;
  REQUIRE(encode(state, wire_state) == nullptr);
  CHECK(wire_state.rotation_xyzw() == std::array<double, 4>{-0.5, 0.5, -0.5, 0.5});

  ContactModel model;
  model.header.sequence = 1;
  model.stiffness << 4, 1e-7, 0, 0, 5, 0, 0, 0, 6;  // asymmetric within the tolerance
  idl::ContactModel wire_model;
  REQUIRE(encode(model, wire_model) == nullptr);
  CHECK(wire_model.stiffness_n_per_m() == std::array<double, 9>{4, 1e-7, 0, 0, 5, 0, 0, 0, 6});
}

TEST_CASE("codec: a message that breaks a rule is not encoded", "[bus]") {
  // Oracle: the rule's field name; that every rule is looked at is tested with the checks.
  ProbeState state;
  state.header.sequence = 1;
  state.pose.position.z() = std::numeric_limits<double>::infinity();
  idl::ProbeState wire;
  CHECK(std::string(encode(state, wire)) == "position_m");
}

TEST_CASE("codec: lists longer than their bound are rejected before they are copied", "[bus]") {
  // Oracle: the bounds of the wire specification.
  CHECK(rejected<Contacts, idl::Contacts>(
            [](auto& wire) { wire.contacts().resize(kMaxContactsPerProbe + 1); }) == "contacts");
  CHECK(rejected<NodePositions, idl::NodePositions>(
            [](auto& wire) { wire.positions_m().resize(3 * kMaxNodes + 3); }) == "positions_m");
  CHECK(rejected_topology([](auto& wire) { wire.rest_positions_m().resize(3 * kMaxNodes + 3); }) ==
        "rest_positions_m");
  CHECK(rejected_topology([](auto& wire) {
          wire.triangle_nodes().resize(3 * kMaxTriangles + 3);
        }) == "triangle_nodes");
  CHECK(rejected_topology([](auto& wire) { wire.fixed_nodes().resize(kMaxNodes + 1); }) ==
        "fixed_nodes");
  CHECK(rejected_topology([](auto& wire) { wire.spring_nodes().resize(2 * kMaxSprings + 2); }) ==
        "spring_nodes");
  CHECK(rejected_status([](auto& wire) { wire.inputs().resize(kMaxInputs + 1); }) == "inputs");
}

TEST_CASE("codec: flat lists must hold whole triangles, springs and nodes", "[bus]") {
  // Oracle: the wire specification.
  CHECK(rejected<NodePositions, idl::NodePositions>(
            [](auto& wire) { wire.positions_m().push_back(0); }) == "positions_m");
  CHECK(rejected_topology([](auto& wire) { wire.rest_positions_m().push_back(0); }) ==
        "rest_positions_m");
  CHECK(rejected_topology([](auto& wire) { wire.triangle_nodes().push_back(0); }) ==
        "triangle_nodes");
  CHECK(rejected_topology([](auto& wire) { wire.spring_nodes().push_back(0); }) == "spring_nodes");
  CHECK(rejected_topology([](auto& wire) { wire.spring_families().push_back(0); }) ==
        "spring_families");
}

TEST_CASE("codec: enumerators that do not exist are rejected, also beyond a byte", "[bus]") {
  // Oracle: the wire specification; 256 would be 0 if narrowed first.
  for (const std::uint32_t value : {7u, 256u, ~0u}) {
    CHECK(rejected_status([&](auto& wire) { wire.state(static_cast<idl::ModuleState>(value)); }) ==
          "state");
  }
  for (const std::uint32_t value : {4u, 256u, ~0u}) {
    CHECK(rejected<SessionControl, idl::SessionControl>([&](auto& wire) {
            wire.command(static_cast<idl::SessionCommand>(value));
          }) == "command");
  }
  CHECK(rejected_topology([](auto& wire) {
          wire.spring_nodes({0, 1});
          wire.spring_families({3});
        }) == "spring_families");
}

TEST_CASE("codec: not finite values on the wire are rejected by field", "[bus]") {
  // Oracle: the wire specification.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(rejected<ProbeState, idl::ProbeState>([&](auto& wire) {
          wire.linear_velocity_m_per_s()[2] = nan;
        }) == "linear_velocity_m_per_s");
  CHECK(rejected<ContactModel, idl::ContactModel>(
            [&](auto& wire) { wire.stiffness_n_per_m()[8] = nan; }) == "stiffness_n_per_m");
  CHECK(rejected<HapticForce, idl::HapticForce>([&](auto& wire) { wire.force_n()[0] = nan; }) ==
        "force_n");
  CHECK(rejected<NodePositions, idl::NodePositions>([&](auto& wire) {
          wire.positions_m().back() = static_cast<float>(nan);
        }) == "positions_m");
}

}  // namespace palpate::bus
