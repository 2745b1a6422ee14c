#include "modules/runtime/wiring.h"

#include <catch2/catch.hpp>

#include "modules/bus/topics.h"
#include "modules/runtime/stage.h"

using namespace palpate;
using namespace palpate::runtime;

namespace {

scene::Scene two_probes_one_organ() {
  scene::Scene scene;
  scene.organs.resize(1);
  scene.probes.resize(2);
  scene.rates = {1000, 300, 100, 30};
  return scene;
}

}  // namespace

TEST_CASE("wiring: every topic it names exists, and its writer and readers are modules") {
  // Oracle: the topics' own list.
  for (const Wire& wire : session_wires()) {
    INFO(wire.topic);
    CHECK(bus::find_topic(wire.topic) != nullptr);
    for (const std::string_view reader : wire.readers) {
      const bool known = std::find(kModules.begin(), kModules.end(), reader) != kModules.end();
      CHECK((reader.empty() || known));
    }
  }
}

TEST_CASE("wiring: cycles lie on whole periods") {
  // Oracle: by hand, 300 Hz is a period of 3,333,333 ns.
  const CycleGrid grid(300);
  CHECK(grid.period_ns() == 3'333'333);
  CHECK(grid.last_at(0) == 0);
  CHECK(grid.last_at(3'333'332) == 0);
  CHECK(grid.last_at(3'333'333) == 3'333'333);
  CHECK(grid.last_before(3'333'333) == 0);
  CHECK(grid.last_before(0) == CycleGrid::kNever);
}

TEST_CASE(
    "wiring: a module waits for what those before it say at the same instant, and sees of "
    "those after it what they said before") {
  // Oracle: by hand.
  const auto scene = two_probes_one_organ();
  const InputRule collision(scene, "collision");
  const std::int64_t at = 10'000'000;  // the third cycle of 300 Hz begins at 9,999,999 ns
  CHECK(collision.required("probe_state", at) == 10'000'000);
  CHECK(collision.horizon("probe_state", at) == at);
  CHECK(collision.keys("probe_state") == 2);
  CHECK(collision.required("node_positions", at) == 0);
  CHECK(collision.horizon("node_positions", at) == at - 1);
  CHECK(collision.keys("node_positions") == 1);
  CHECK(collision.required("node_positions", 0) == CycleGrid::kNever);
  CHECK(collision.required("surface", 0) == CycleGrid::kSetUp);

  const InputRule haptics(scene, "haptics");
  CHECK(haptics.required("contact_model", at) == 0);
  CHECK(haptics.keys("probe_input") == 0);  // an outside program is waited for by nobody

  const InputRule recorder(scene, "recorder");
  CHECK(recorder.required("contact_model", at) == at);
  CHECK(recorder.required("contacts", at) == 9'999'999);
  CHECK(recorder.keys("scene") == 1);
}

TEST_CASE("wiring: a job that several processes share has a name for each") {
  // Oracle: the names by hand.
  CHECK(name_of({"deformation", 1}) == "deformation");
  CHECK(name_of({"deformation", 12}) == "deformation_12");
  for (const char* name : {"haptics", "deformation", "deformation_2", "deformation_16"}) {
    const auto module = module_named(name);
    REQUIRE(module);
    CHECK(name_of(*module) == name);
  }
  for (const char* name : {"deformation_", "deformation_1", "deformation_02", "deformation_17",
                           "deformation_2x", "haptics_2", "", "all"}) {
    CHECK_FALSE(module_named(name));
  }
}

TEST_CASE("wiring: each process of deformation waits alike, and haptics for all of them") {
  // Oracle: by hand; two probes, two processes.
  scene::Scene scene = two_probes_one_organ();
  scene.organs.resize(2);
  scene.organs[1].process = 2;
  const InputRule first(scene, "deformation"), second(scene, "deformation_2");
  for (const std::int64_t at : {0, 4'000'000}) {
    for (const char* topic : {"probe_state", "contacts"}) {
      CHECK(second.required(topic, at) == first.required(topic, at));
      CHECK(second.horizon(topic, at) == first.horizon(topic, at));
      CHECK(second.keys(topic) == first.keys(topic));
    }
  }
  CHECK(rate_of("deformation_2", scene) == rate_of("deformation", scene));
  CHECK(InputRule(scene, "haptics").keys("contact_model") == 4);
  CHECK(InputRule(scene, "collision").keys("node_positions") == 2);
  CHECK(reader_count("contacts", {"haptics", "collision", "deformation", "deformation_2"}) == 2);
}

TEST_CASE("wiring: a topic's readers are counted among those who take part") {
  // Oracle: by hand.
  CHECK(reader_count("probe_state", {"haptics", "collision", "deformation"}) == 2);
  CHECK(reader_count("probe_state", {"haptics", "collision", "deformation", "recorder"}) == 3);
  CHECK(reader_count("contact_model", {"haptics", "visualizer"}) == 2);
  CHECK(reader_count("module_status", {"visualizer", "recorder"}) == 0);
}

TEST_CASE("wiring: what another one's cycle waits for is told from what can wait") {
  // Oracle: by hand, of 1000, 300, 100 and 30 Hz.
  const auto scene = two_probes_one_organ();
  const std::vector<std::string> loop{"haptics", "collision", "deformation"};
  const auto awaited = [&](const char* module, std::int64_t time_ns) {
    return is_awaited(module, time_ns, scene, loop);
  };
  CHECK(awaited("haptics", 0));
  CHECK_FALSE(awaited("haptics", 1'000'000));
  CHECK_FALSE(awaited("haptics", 2'000'000));
  CHECK(awaited("haptics", 3'000'000));  // by collision at 3.333333 ms
  CHECK(awaited("haptics", 10'000'000));
  CHECK_FALSE(awaited("collision", 3'333'333));  // deformation goes on at 10 ms
  CHECK(awaited("collision", 9'999'999));
  CHECK(awaited("deformation", 0));
  CHECK(awaited("deformation", 10'000'000));
  CHECK(is_awaited("deformation_2", 10'000'000, scene, loop));

  CHECK_FALSE(is_awaited("haptics", 3'000'000, scene, {"haptics", "deformation", "recorder"}));
  CHECK(is_awaited("haptics", 33'000'000, scene, {"haptics", "visualizer"}));  // at 33.333333 ms
  CHECK_FALSE(is_awaited("haptics", 32'000'000, scene, {"haptics", "visualizer"}));
  CHECK_FALSE(is_awaited("visualizer", 0, scene, loop));
}

TEST_CASE("wiring: a scene that lets laws grow old lets probes and contacts, and none is hurried") {
  // Oracle: the rule. A limit below 50 ms would be shorter than the period of slow collision.
  scene::Scene scene = two_probes_one_organ();
  CHECK(input_stale_after(scene) == kInputStaleAfter);
  scene.haptics.stale_after = 0.3;
  CHECK(input_stale_after(scene) == 0.3);
  scene.haptics.stale_after = 0.005;
  CHECK(input_stale_after(scene) == kInputStaleAfter);
  scene.rates.collision = 10;
  CHECK(input_stale_after(scene) == Approx(0.2));
}
