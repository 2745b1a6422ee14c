#include "palpate/rerun.h"

#include <catch2/catch.hpp>
#include <map>
#include <sstream>

#include "modules/core/error.h"
#include "modules/messages/cdr.h"
#include "modules/recording/sample_reader.h"
#include "palpate/replay_command.h"
#include "palpate/run_command.h"
#include "tests/palpate/ball_scene.h"
#include "tests/scratch_folder.h"

using namespace palpate;
using namespace palpate::launcher;
using Catch::Contains;

namespace {

constexpr const char* kPressAndSlide =
    "scripted: {start_m: [0, 0, 0.065], moves: [{to_m: [0.01, 0, 0.045], duration_s: 0.3}]}";

/// Some stages of a recording again; "" or what is wrong.
std::string rerun(const std::filesystem::path& from, const std::vector<std::string>& stages,
                  const std::filesystem::path& to, std::vector<std::string> settings = {}) {
  RunOptions run;
  run.record = to;
  run.overwrite = true;
  run.settings = std::move(settings);
  Playing playing;
  playing.rerun = stages;
  std::ostringstream out, log;
  try {
    return replay_command(from, playing, run, out, log) == kExitDone ? "" : "failed";
  } catch (const InputError& error) {
    return error.what();
  }
}

std::filesystem::path recorded(const palpate::testing::BallScene& scene) {
  RunOptions run;
  run.scene = scene.file();
  run.in_process = true;
  run.duration = 0.4;
  run.record = scene.folder() / "run.mcap";
  std::ostringstream out, log;
  REQUIRE(run_command(run, out, log) == kExitDone);
  return run.record;
}

}  // namespace

TEST_CASE("rerun: any stages of a recording in lockstep leave its bytes again") {
  // Oracle: the recording itself.
  const palpate::testing::BallScene scene(kPressAndSlide,
                                          "rates: {collision_hz: 300, deformation_hz: 100}\n");
  const auto run = recorded(scene);
  const std::string expected = text_in(run);
  REQUIRE(expected.size() > 50'000);
  const std::vector<std::string> all{"haptics", "collision", "deformation"};
  for (int choice = 1; choice < 8; ++choice) {
    std::vector<std::string> stages;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if ((choice >> k & 1) != 0) stages.push_back(all[k]);
    }
    INFO(choice);
    const auto again = scene.folder() / "again.mcap";
    REQUIRE(rerun(run, stages, again) == "");
    CHECK(text_in(again) == expected);
  }
}

TEST_CASE("rerun: with another setting only what is computed anew differs") {
  // Oracle: forces no larger than the setting's; poses and laws as they were recorded.
  const palpate::testing::BallScene scene(kPressAndSlide);
  const auto run = recorded(scene), again = scene.folder() / "again.mcap";
  REQUIRE(rerun(run, {"haptics"}, again, {"haptics.max_force_n=0.1"}) == "");
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> before, after;
  for (auto* samples : {&before, &after}) {
    recording::SampleReader reader(samples == &before ? run : again);
    while (const auto sample = reader.next()) {
      (*samples)[std::string(sample->topic->name)].push_back(sample->payload);
    }
  }
  for (const char* topic : {"probe_state", "contact_model", "contacts", "node_positions"}) {
    INFO(topic);
    CHECK(before[topic].size() > 10);
    CHECK(before[topic] == after[topic]);
  }
  CHECK(before["haptic_force"].size() == after["haptic_force"].size());
  double largest_before = 0, largest = 0;
  for (const auto& [samples, most] : {std::pair{&before, &largest_before}, {&after, &largest}}) {
    for (const auto& payload : (*samples)["haptic_force"]) {
      HapticForce force;
      REQUIRE(messages::decode(payload, force) == nullptr);
      *most = std::max(*most, force.force.norm());
    }
  }
  CHECK(largest_before > 0.12);
  CHECK(largest > 0.08);
  CHECK(largest <= 0.1 + 1e-6);
}

TEST_CASE("rerun: what cannot be computed anew is refused by name") {
  // Oracle: the messages.
  const palpate::testing::BallScene scene(kPressAndSlide);
  const auto run = recorded(scene), again = scene.folder() / "again.mcap";
  CHECK_THAT(rerun(run, {"visualizer"}, again), Contains("there is no stage 'visualizer'"));
  CHECK_THAT(rerun(run, {"haptics"}, {}), Contains("Give --record FILE"));
  CHECK_THAT(rerun(run, {"haptics"}, scene.folder() / "none" / "x.mcap"), Contains("none"));
  CHECK_THAT(rerun(scene.file(), {"haptics"}, again), Contains("press.yaml"));
}
