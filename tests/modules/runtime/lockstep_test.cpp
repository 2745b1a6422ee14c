#include "modules/runtime/lockstep.h"

#include <catch2/catch.hpp>
#include <functional>

#include "modules/bus/memory_bus.h"
#include "tests/times.h"

using namespace palpate;
using namespace palpate::runtime;

namespace {

scene::Scene one_probe() {
  scene::Scene scene;
  scene.organs.resize(1);
  scene.probes.resize(1);
  scene.rates = {1000, 250, 250, 30};
  return scene;
}

/// Notes the source times of the contact models it hears, cycle by cycle.
class Listener : public Stage {
 public:
  explicit Listener(bus::Bus& bus) : models_(bus.reader(bus::kContactModel)) {}
  Health cycle(const Cycle& now) override {
    cycles.push_back(now.sim_time_ns);
    ContactModel model;
    while (models_.take(model)) heard.emplace_back(now.sim_time_ns, model.header.source_time_ns);
    return {};
  }
  void prepare() override {
    ContactModel model;
    while (models_.take(model)) ++prepared;
  }
  void finish(const Cycle& now) override { finished_at = now.sim_time_ns; }

  std::vector<std::int64_t> cycles;
  std::vector<std::pair<std::int64_t, std::int64_t>> heard;  ///< cycle, source time
  std::uint32_t prepared = 0;
  std::int64_t finished_at = -1;

 private:
  bus::Reader<ContactModel> models_;
};

/// Takes poses as soon as it may, contacts in its cycles.
class Preparing : public Stage {
 public:
  explicit Preparing(bus::Bus& bus)
      : poses_(bus.reader(bus::kProbeState)), contacts_(bus.reader(bus::kContacts)) {}
  Health cycle(const Cycle&) override {
    take_poses();
    Contacts found;
    while (contacts_.take(found)) contacts.push_back(found.header.source_time_ns);
    return {};
  }
  void prepare() override {
    take_poses();
    if (meanwhile) meanwhile();
  }
  std::vector<std::int64_t> poses, contacts;  ///< source times
  std::function<void()> meanwhile;            ///< what happens while it prepares

 private:
  void take_poses() {
    ProbeState pose;
    while (poses_.take(pose)) poses.push_back(pose.header.source_time_ns);
  }
  bus::Reader<ProbeState> poses_;
  bus::Reader<Contacts> contacts_;
};

struct Haptics {
  scene::Scene scene = one_probe();
  bus::MemoryBus bus{true};
  bus::Writer<ContactModel> models = bus.writer(bus::kContactModel);
  Listener stage{bus};
  LockstepCursor cursor{scene, "haptics", {bus.inputs().begin(), bus.inputs().end()}};

  void say(std::int64_t source_time_ns) {
    ContactModel model;
    bus.set_clock([source_time_ns] { return source_time_ns; });
    model.header.source_time_ns = source_time_ns;
    REQUIRE(models.write(model));
  }
};

}  // namespace

TEST_CASE("lockstep: a cycle waits for its inputs, however late they come") {
  // Oracle: the rule by hand: haptics at t needs the model of the last deformation cycle before t.
  Haptics h;
  CHECK(h.cursor.missing() == nullptr);  // nobody spoke before the first cycle
  h.cursor.step(h.stage);
  CHECK(h.cursor.next_ns() == kMs);
  REQUIRE(h.cursor.missing() != nullptr);
  CHECK(h.cursor.missing()->topic().name == "contact_model");
  h.say(0);
  CHECK(h.cursor.missing() == nullptr);
}

TEST_CASE("lockstep: what is said first is waited for first") {
  // Oracle: the order of a period: haptics tells poses, then collision contacts, then deformation
  // works. Poses are read while collision searches.
  const scene::Scene scene = one_probe();
  bus::MemoryBus bus(true);
  const auto poses = bus.reader(bus::kProbeState);
  const auto contacts = bus.reader(bus::kContacts);
  LockstepCursor cursor(scene, "deformation", {bus.inputs().begin(), bus.inputs().end()});
  const auto missing = [&] { return cursor.missing() ? cursor.missing()->topic().name : ""; };
  bus.set_clock([] { return std::int64_t{0}; });
  CHECK(missing() == "probe_state");
  ProbeState pose;
  REQUIRE(bus.writer(bus::kProbeState).write(pose));
  CHECK(missing() == "contacts");
  Contacts found;
  REQUIRE(bus.writer(bus::kContacts).write(found));
  CHECK(missing() == "");
}

TEST_CASE("lockstep: while something is missing a stage takes what it reads before that, no more") {
  // Oracle: by hand. Deformation at 4 ms needs poses and contacts of 4 ms; those of 5 ms are later.
  const scene::Scene scene = one_probe();
  bus::MemoryBus bus(true);
  std::int64_t now = 0;
  bus.set_clock([&] { return now; });
  Preparing stage(bus);
  LockstepCursor cursor(scene, "deformation", {bus.inputs().begin(), bus.inputs().end()});
  auto poses = bus.writer(bus::kProbeState);
  auto contacts = bus.writer(bus::kContacts);
  const auto say = [&](auto& writer, auto message, std::int64_t at) {
    now = at;
    REQUIRE(writer.write(message));
  };
  bus::Input* missing = cursor.missing();
  REQUIRE(missing != nullptr);
  CHECK(cursor.prepare(stage, *missing) == missing);  // nothing is read before poses
  CHECK(stage.poses.empty());
  say(poses, ProbeState{}, 0);
  say(contacts, Contacts{}, 0);
  REQUIRE(cursor.missing() == nullptr);
  cursor.step(stage);
  CHECK(stage.poses == std::vector<std::int64_t>{0});

  for (const std::int64_t at : {1, 2, 3, 4, 5}) say(poses, ProbeState{}, at * kMs);
  missing = cursor.missing();
  REQUIRE(missing != nullptr);
  CHECK(missing->topic().name == "contacts");
  CHECK(cursor.prepare(stage, *missing) == missing);
  CHECK(stage.poses == std::vector<std::int64_t>{0, kMs, 2 * kMs, 3 * kMs, 4 * kMs});
  CHECK(cursor.prepare(stage, *missing) == missing);
  CHECK(stage.poses.size() == 5);
  CHECK(stage.contacts == std::vector<std::int64_t>{0});
  say(contacts, Contacts{}, 4 * kMs);
  REQUIRE(cursor.missing() == nullptr);
  cursor.step(stage);
  CHECK(stage.poses.size() == 5);
  CHECK(stage.contacts == std::vector<std::int64_t>{0, 4 * kMs});

  // What comes while the stage prepares ends no wait: it is not missing after it.
  for (const std::int64_t at : {6, 7, 8}) say(poses, ProbeState{}, at * kMs);
  missing = cursor.missing();
  REQUIRE(missing != nullptr);
  stage.meanwhile = [&] { say(contacts, Contacts{}, 8 * kMs); };
  CHECK(cursor.prepare(stage, *missing) == nullptr);
}

TEST_CASE("lockstep: laws of one process are taken while another's are missing") {
  // Oracle: by hand; two processes, each with an organ.
  scene::Scene scene = one_probe();
  scene.organs.resize(2);
  scene.organs[1].process = 2;
  bus::MemoryBus bus(true);
  bus.set_clock([] { return std::int64_t{0}; });
  auto models = bus.writer(bus::kContactModel);
  Listener stage(bus);
  LockstepCursor cursor(scene, "haptics", {bus.inputs().begin(), bus.inputs().end()});
  REQUIRE(cursor.missing() == nullptr);
  cursor.step(stage);
  const auto say = [&](std::uint32_t process) {
    ContactModel model;
    model.process = process;
    REQUIRE(models.write(model));
  };
  for (const std::uint32_t process : {1u, 2u}) {
    bus::Input* const missing = cursor.missing();
    REQUIRE(missing != nullptr);
    CHECK(cursor.prepare(stage, *missing) == missing);
    CHECK(stage.prepared == process - 1);
    say(process);
    CHECK((cursor.missing() == nullptr) == (process == 2));
  }
  cursor.step(stage);
  CHECK(stage.heard.size() == 1);  // the other one was taken before
}

TEST_CASE("lockstep: a cycle sees nothing of the future, however early it comes") {
  // Oracle: the same run with samples that come just in time.
  Haptics early, in_time;
  for (const std::int64_t t : {0, 4, 8}) early.say(t * kMs);
  for (int i = 0; i < 10; ++i) {
    while (in_time.cursor.missing() != nullptr) {
      in_time.say((in_time.cursor.next_ns() - 1) / (4 * kMs) * 4 * kMs);
    }
    in_time.cursor.step(in_time.stage);
    REQUIRE(early.cursor.missing() == nullptr);
    early.cursor.step(early.stage);
  }
  CHECK(early.stage.cycles == in_time.stage.cycles);
  CHECK(early.stage.heard == in_time.stage.heard);
  CHECK(early.stage.heard == std::vector<std::pair<std::int64_t, std::int64_t>>{
                                 {kMs, 0}, {5 * kMs, 4 * kMs}, {9 * kMs, 8 * kMs}});
}

TEST_CASE("lockstep: the end waits for what was said before it") {
  // Oracle: by hand, the last deformation cycle before 10 ms begins at 8 ms.
  Haptics h;
  h.say(0);
  h.say(4 * kMs);
  CHECK(h.cursor.missing_before_end(10 * kMs) != nullptr);
  h.say(8 * kMs);
  CHECK(h.cursor.missing_before_end(10 * kMs) == nullptr);
  h.cursor.finish(h.stage, 10 * kMs);
  CHECK(h.stage.finished_at == 10 * kMs - 1);
}
