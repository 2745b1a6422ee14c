#include "modules/messages/messages.h"

#include <bit>
#include <catch2/catch.hpp>
#include <set>

using namespace palpate;

TEST_CASE("messages: fresh ones describe rest, nothing touching and no force") {
  // Oracle: what each default must mean to a reader that gets it before anything happened.
  CHECK(Header{}.sequence == 0);
  CHECK(ProbeState{}.pose.position == Vec3::Zero());
  CHECK(ProbeState{}.twist.linear == Vec3::Zero());
  CHECK(ProbeState{}.twist.angular == Vec3::Zero());
  CHECK(Contacts{}.contacts.empty());
  CHECK_FALSE(Contacts{}.truncated);
  CHECK_FALSE(ContactModel{}.touching());
  CHECK(ContactModel{}.force() == Vec3::Zero());
  CHECK(ContactModel{}.stiffness == Mat3::Zero());
  CHECK(ContactModel{}.validity_radius == 0);
  CHECK(HapticForce{}.force == Vec3::Zero());
  CHECK(HapticForce{}.limits == kForceNotLimited);
  CHECK(ModuleStatus{}.state == ModuleState::kStarting);
  CHECK(SceneDescription{}.protocol_version == kProtocolVersion);
}

TEST_CASE("messages: a fresh contact and a fresh row of a law have a unit normal") {
  // Oracle: the field's definitions in messages.h.
  const Contact contact;
  CHECK(contact.normal_P.norm() == 1);
  CHECK(LawRow{}.normal.norm() == 1);
}

TEST_CASE("messages: each force limit is a bit of its own") {
  // Oracle: population count, and no two equal.
  const std::set<std::uint32_t> bits{kForceSaturated, kForceSlewLimited, kForceStaleFade,
                                     kForcePassivity, kForceNotFinite,   kForceOutOfValidity};
  CHECK(bits.size() == 6);
  for (const std::uint32_t bit : bits) CHECK(std::popcount(bit) == 1);
}

TEST_CASE("messages: enumerations keep their numbers on the wire") {
  // Oracle: the numbers published since version 1; changing one needs a new protocol version.
  REQUIRE(kProtocolVersion == 14);
  CHECK(static_cast<int>(SpringFamily::kStructural) == 0);
  CHECK(static_cast<int>(SpringFamily::kBending) == 1);
  CHECK(static_cast<int>(SpringFamily::kInner) == 2);
  CHECK(static_cast<int>(ModuleState::kStarting) == 0);
  CHECK(static_cast<int>(ModuleState::kRunning) == 2);
  CHECK(static_cast<int>(ModuleState::kFault) == 5);
  CHECK(static_cast<int>(ModuleState::kStopped) == 6);
  CHECK(static_cast<int>(SessionCommand::kStart) == 0);
  CHECK(static_cast<int>(SessionCommand::kStop) == 3);
  CHECK(static_cast<int>(SessionCommand::kStep) == 4);
}

TEST_CASE("messages: the bounds hold the largest organ that is promised") {
  // Oracle: Euler's formula F = 2 V − 4 for a closed surface without handles, and the refined
  // stomach's 19 000 nodes and 38 000 triangles.
  CHECK(kMaxNodes >= 19'000);
  CHECK(kMaxTriangles >= 2 * kMaxNodes - 4);
  // 3 V − 6 edges, about 6 V second neighbours and one inner spring per node.
  CHECK(kMaxSprings >= 10 * kMaxNodes);
}
