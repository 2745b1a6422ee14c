// A module that is there already, started once more.
#include <catch2/catch.hpp>

#include "modules/core/units.h"
#include "modules/recording/sample_reader.h"
#include "modules/runtime/name_claim.h"
#include "tests/system/launched.h"

using namespace palpate;
using namespace palpate::testing;
using Catch::Contains;

TEST_CASE("second module: one by hand is refused, and the first is felt as before") {
  // Oracle: exit code and words; the recording, whose samples of a force all are of one writer, so
  // that their numbers never go back.
  const BallScene scene(
      "scripted: {start_m: [0, 0, 0.07], moves: [{to_m: [0, 0, 0.055], duration_s: 1}]}");
  const auto recording = scene.folder() / "r.mcap";
  Launched run(scene, {"--duration", "8", "--record", recording.string()});
  REQUIRE(run.wait_for_text(" s  real time"));
  const pid_t first = run.processes().at("palpate-haptics");
  for (const char* module : {"haptics", "deformation"}) {
    Running second(bin(std::string("palpate-") + module),
                   joined({scene.file().string()}, run.options()));
    CHECK(second.wait_for_end() == 2);
    CHECK_THAT(second.said(), Contains("session '" + run.options().session + "' has " + module +
                                       " here already, process "));
  }
  CHECK(run.processes().at("palpate-haptics") == first);
  CHECK(run.wait_for_end() == 0);
  CHECK_THAT(run.said(), !Contains("several processes"));
  recording::SampleReader reader(recording);
  std::uint64_t last = 0;
  while (const auto sample = reader.next()) {
    if (sample->topic->name != bus::kHapticForce.name) continue;
    const std::uint64_t sequence = messages::header_of(sample->payload).sequence;
    CHECK(sequence > last);
    last = sequence;
  }
  CHECK(last > 1000);
}

TEST_CASE("second module: a launcher starts nothing beside what somebody started by hand") {
  // Oracle: exit code, words, the process table.
  const BallScene scene;
  const bus::BusOptions own = own_bus_options();
  Running haptics(bin("palpate-haptics"), joined({scene.file().string()}, own));
  REQUIRE(wait_until(
      [&] { return runtime::NameClaim::holder(runtime::process_name(own, "haptics")) > 0; }));
  Launched run(scene, {"--duration", "1"}, own);
  CHECK(run.wait_for_end() == 2);
  CHECK_THAT(run.said(), Contains("session '" + own.session + "' has haptics here already"));
  CHECK_FALSE(haptics.child().ended());
  CHECK(run.processes().size() == 1);
  haptics.child().signal(SIGTERM);  // its end is waited for, not refused
  Launched after(scene, {"--duration", "1"}, own);
  CHECK(after.wait_for_end() == 0);
}
