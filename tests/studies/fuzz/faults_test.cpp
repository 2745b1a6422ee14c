#include "studies/fuzz/faults.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "modules/bus/memory_bus.h"

namespace palpate::fuzz {
namespace {

/// A scene with one fault of probe 0 at 10 ms; a period of deformation is 4 ms.
RandomScene scene_with(Fault fault) {
  RandomScene scene;
  scene.scene.probes.push_back({"probe", scene::SphereShape{}, 0, scene::ScriptedDevice{}});
  scene.faults.push_back({fault, 0, 0.01});
  return scene;
}

struct Passed {
  std::vector<int> arrived;    ///< the ticks at which samples were written that arrived
  std::uint64_t rejected = 0;  ///< by the reader
};

/// 200 messages of `probe`, one a millisecond, past the fault.
template <class Message>
Passed pass(Fault fault, const bus::TopicOf<Message>& topic, Message message,
            std::uint32_t probe = 0) {
  bus::MemoryBus carrier(true);
  bus::TappedBus bus(carrier);
  std::int64_t now_ns = 0;
  bus.set_clock([&] { return now_ns; });
  tap_faults(scene_with(fault), bus);
  auto writer = bus.writer(topic);
  auto reader = bus.reader(topic);
  Passed passed;
  for (int tick = 0; tick < 200; ++tick) {
    now_ns = 1'000'000 * tick;
    message.probe = probe;
    message.header.sim_time_ns = message.header.source_time_ns = now_ns;
    REQUIRE(writer.write(message));
    Message taken;
    while (reader.take(taken)) {
      passed.arrived.push_back(static_cast<int>(taken.header.sim_time_ns / 1'000'000));
    }
  }
  passed.rejected = reader.statistics().rejected;
  return passed;
}

Contacts one_contact() {
  Contacts contacts;
  contacts.contacts.resize(1);
  contacts.contacts[0].barycentric = Vec3(1, 0, 0);
  return contacts;
}

TEST_CASE("faults: what is not a number is refused by readers, what is only odd is let through") {
  // Oracle: the rules of the wire; four ticks of 1 ms lie in a period of deformation.
  const auto refused_poses = [](Fault fault) {
    return pass(fault, bus::kProbeState, ProbeState()).rejected;
  };
  CHECK(refused_poses(Fault::kPoseNotANumber) == 4);
  CHECK(refused_poses(Fault::kPoseInfinite) == 4);
  CHECK(refused_poses(Fault::kRotationZero) == 4);
  CHECK(refused_poses(Fault::kPoseDenormal) == 0);
  CHECK(refused_poses(Fault::kGapNotANumber) == 0);  // not its message
  CHECK(pass(Fault::kGapNotANumber, bus::kContacts, one_contact()).rejected == 4);
  CHECK(pass(Fault::kUnknownOrgan, bus::kContacts, one_contact()).rejected == 0);
  CHECK(pass(Fault::kModelNotANumber, bus::kContactModel, ContactModel()).rejected == 4);
}

TEST_CASE("faults: messages are lost, late or repeated for 0.1 s, those of the probe alone") {
  // Oracle: the order of ticks, by hand: a delay of 30 ms ends with the spell, so what waits then
  // is lost.
  const auto ticks = [](Fault fault, std::uint32_t probe) {
    return pass(fault, bus::kProbeState, ProbeState(), probe).arrived;
  };
  CHECK(ticks(Fault::kLost, 0).size() == 100);
  CHECK(ticks(Fault::kTwice, 0).size() == 300);
  const auto late = ticks(Fault::kLate, 0);
  REQUIRE(late.size() == 170);
  CHECK(late[10] == 10);
  CHECK(late[79] == 79);
  CHECK(late[80] == 110);
  for (const Fault fault : {Fault::kLost, Fault::kTwice, Fault::kLate, Fault::kPoseNotANumber}) {
    CHECK(ticks(fault, 1).size() == 200);
  }
}

TEST_CASE("faults: a failing device reads no numbers for a period of deformation") {
  // Oracle: the fault's time; a scripted device that rests.
  const auto device = faulty_device(scene_with(Fault::kDeviceNotANumber), 0);
  CHECK(device->read(0.009).pose.position.allFinite());
  CHECK_FALSE(device->read(0.01).pose.position.allFinite());
  CHECK_FALSE(device->read(0.0139).pose.position.allFinite());
  CHECK(device->read(0.0141).pose.position.allFinite());
}

}  // namespace
}  // namespace palpate::fuzz
