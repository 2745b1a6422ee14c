#include "modules/runtime/lockstep.h"

#include <catch2/catch.hpp>

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
  void finish(const Cycle& now) override { finished_at = now.sim_time_ns; }

  std::vector<std::int64_t> cycles;
  std::vector<std::pair<std::int64_t, std::int64_t>> heard;  ///< cycle, source time
  std::int64_t finished_at = -1;

 private:
  bus::Reader<ContactModel> models_;
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
