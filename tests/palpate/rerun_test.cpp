#include "palpate/rerun.h"

#include <catch2/catch.hpp>
#include <limits>
#include <map>
#include <sstream>

#include "modules/core/error.h"
#include "modules/messages/cdr.h"
#include "modules/messages/message_checks.h"
#include "modules/recording/diff.h"
#include "modules/recording/inspect.h"
#include "modules/recording/sample_reader.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/settings.h"
#include "palpate/replay_command.h"
#include "palpate/run_command.h"
#include "tests/modules/recording/payloads.h"
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
                  const std::filesystem::path& to, std::vector<std::string> settings = {},
                  const std::filesystem::path& scene = {}) {
  RunOptions run;
  run.scene = scene;
  run.record = to;
  run.overwrite = true;
  run.settings = std::move(settings);
  Playing playing;
  playing.rerun = stages;
  std::ostringstream out, log;
  try {
    return replay_command(from, playing, run, out, log) == kExitDone ? log.str() : "failed";
  } catch (const InputError& error) {
    return error.what();
  }
}

std::filesystem::path recorded(const palpate::testing::BallScene& scene, RunOptions run = {}) {
  run.overwrite = true;
  run.scene = scene.file();
  run.in_process = true;
  run.duration = 0.4;
  run.record = scene.folder() / "run.mcap";
  std::ostringstream out, log;
  REQUIRE(run_command(run, out, log) == kExitDone);
  return run.record;
}

}  // namespace

TEST_CASE("rerun: any stages of a recording in lockstep leave its samples again, labelled so") {
  // Oracle: the recording itself.
  const palpate::testing::BallScene scene(kPressAndSlide,
                                          "rates: {collision_hz: 300, deformation_hz: 100}\n");
  const auto run = recorded(scene);
  const std::vector<std::string> all{"collision", "deformation", "haptics"};
  for (int choice = 1; choice < 8; ++choice) {
    std::vector<std::string> stages;
    std::string label;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if ((choice >> k & 1) == 0) continue;
      label += (stages.empty() ? "" : ", ") + all[k];
      stages.push_back(all[k]);
    }
    INFO(choice);
    const auto again = scene.folder() / "again.mcap";
    REQUIRE(rerun(run, stages, again) == "");
    const auto difference = recording::compare({run, again});
    CHECK(difference.equal());
    CHECK(difference.topics.at("haptic_force").compared == 400);
    const auto summary = recording::summarize(again);
    CHECK(summary.rerun.at("stages") == label);
    CHECK(summary.rerun.at("recording") == "run.mcap");
    CHECK(summary.rerun.at("digest") == summary.scene.at("digest"));
  }
}

TEST_CASE("rerun: says where it ends before what was asked for, and where it was told to") {
  // Oracle: 0.4 s of recording.
  const palpate::testing::BallScene scene(kPressAndSlide);
  const auto run = recorded(scene);
  const auto log_of = [&](double duration) {
    RunOptions options;
    options.record = scene.folder() / "again.mcap";
    options.overwrite = true;
    options.duration = duration;
    Playing playing;
    playing.rerun = {"haptics"};
    std::ostringstream out, log;
    CHECK(replay_command(run, playing, options, out, log) == kExitDone);
    return log.str();
  };
  CHECK(log_of(100) == "palpate: the recording ends there, before the 100 s asked for\n");
  CHECK(log_of(0.3).empty());
  CHECK(log_of(0).empty());
}

TEST_CASE("rerun: another organ is tried on the recorded hand, and the output is of its scene") {
  // Oracle: the scene that was given; poses as they were recorded, another law.
  const palpate::testing::BallScene scene(kPressAndSlide);
  const auto run = recorded(scene), again = scene.folder() / "again.mcap";
  const auto softer = scene.folder() / "softer.yaml";
  std::ofstream(softer) << scene::resolved_text(
      scene::load_scene_with(scene.file(), {"name=softer", "organs[0].tissue.youngs_modulus_pa=8e3",
                                            "organs[0].mesh.nodes=200", "haptics.max_force_n=1"}));
  REQUIRE(rerun(run, {"collision", "deformation"}, again, {}, softer) == "");
  const auto summary = recording::summarize(again);
  CHECK(summary.scene.at("name") == "softer");
  CHECK(summary.rerun.at("scene") == "press");
  CHECK(summary.scene.at("digest") != summary.rerun.at("digest"));
  const auto difference = recording::compare({run, again});
  CHECK(difference.topics.at("probe_state").differing == 0);
  CHECK(difference.topics.at("contact_model").differing > 10);
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
  CHECK_FALSE(std::filesystem::exists(again));
}

TEST_CASE("rerun: a recording that is no stand-in is refused by name, and nothing written") {
  // Oracle: the messages. It began at a snapshot, has not what is read, or is of another organ.
  const palpate::testing::BallScene scene(kPressAndSlide);
  const auto again = scene.folder() / "again.mcap";
  RunOptions saving, going_on, selected;
  saving.snapshot_at = 0.2;
  saving.snapshot = going_on.from_snapshot = scene.folder() / "at.snapshot";
  selected.record_topics = {"haptic_force", "probe_state"};
  recorded(scene, saving);
  const auto rest = recorded(scene, going_on);
  CHECK_THAT(rerun(rest, {"haptics"}, again),
             Contains("begins 0.2 s after its session, or at a snapshot"));
  const auto forces = recorded(scene, selected);
  CHECK_THAT(rerun(forces, {"haptics"}, again), Contains("holds no contact_model, which haptics"));
  CHECK_THAT(rerun(forces, {"deformation"}, again), Contains("holds no contacts, which deform"));
  CHECK_THAT(rerun(recorded(scene), {"haptics"}, again, {"gravity_m_per_s2=[0, 0, -1]"}),
             Contains("in what other stages than haptics read"));
  CHECK_FALSE(std::filesystem::exists(again));
}

TEST_CASE("rerun: a torn recording is warned of") {
  // Oracle: the reader's own warning.
  const palpate::testing::BallScene scene(kPressAndSlide);
  const auto run = recorded(scene);
  std::filesystem::resize_file(run, std::filesystem::file_size(run) - 200);
  CHECK_THAT(rerun(run, {"haptics"}, scene.folder() / "again.mcap"),
             Contains("warning: " + run.string() + ": not closed by its writer"));
}

TEST_CASE("rerun: a driver that said nothing is no missing topic, one that was not recorded is") {
  // Oracle: the recording itself; the message. It was refused: "holds no probe_input".
  const palpate::testing::BallScene scene("topic: {start_m: [0, 0, 0.058]}");
  const auto run = recorded(scene), again = scene.folder() / "again.mcap";
  REQUIRE(rerun(run, {"haptics"}, again) == "");
  CHECK(recording::compare({run, again}).equal());
  RunOptions selected;
  selected.record_topics = {"haptic_force", "probe_state", "contact_model"};
  CHECK_THAT(rerun(recorded(scene, selected), {"haptics"}, again),
             Contains("holds no probe_input, which haptics reads"));
}

TEST_CASE("rerun: a mesh and a motion that are gone, or changed, are the recording's own") {
  // Oracle: the recording itself; the bytes of its files.
  palpate::testing::BallScene scene;
  const auto mesh = scene.folder() / "ball.ply", moves = scene.folder() / "moves.csv";
  std::ofstream(moves) << "t,x,y,z,qx,qy,qz,qw\n0,0,0,0.065,0,0,0,1\n0.4,0.01,0,0.045,0,0,0,1\n";
  scene.set_device("trajectory: {file: moves.csv}");
  const auto run = recorded(scene), again = scene.folder() / "again.mcap";
  const auto third = scene.folder() / "third.mcap";
  std::filesystem::remove(moves);
  geometry::write_surface(geometry::make_ball(0.04, 3), mesh);
  const std::string said = rerun(run, {"haptics", "collision"}, again);
  CHECK_THAT(said, Contains(mesh.string() + ": has changed since; taken from the recording"));
  CHECK_THAT(said, Contains(moves.string() + ": is not there; taken from the recording"));
  CHECK(recording::compare({run, again}).equal());
  // What was computed has them in turn, though its files are not those that lie there.
  CHECK_THAT(rerun(again, {"deformation"}, third), Contains("taken from the recording"));
  CHECK(recording::compare({run, third}).equal());
  CHECK(recording::summarize(third).scene.at("digest") ==
        recording::summarize(run).scene.at("digest"));
}

TEST_CASE("rerun: a driver that stamps by a clock of its own is heard when it came") {
  // Oracle: the probe goes as the driver says, and the rerun ends where the recording does. Stamped
  // by the time of day it was waited for for ever, and nothing behind it came. Nor is what a
  // stranger said of the future waited for, or a command that no module believed obeyed.
  const palpate::testing::BallScene scene("topic: {start_m: [0, 0, 0.09]}");
  const auto silent = recorded(scene), again = scene.folder() / "again.mcap";
  const auto run = scene.folder() / "real_time.mcap";
  constexpr std::int64_t kStart = 5'000'000'000, kDay = 1'700'000'000'000'000'000;
  {
    using recording::raw_sample;
    recording::SampleFile file(run, {}, {1, 1});
    SessionControl control;
    control.header = {1, 0, kStart, 0};
    control.start_time_ns = kStart;
    file.add(raw_sample(bus::kSessionControl, control, kStart));
    control.start_time_ns = -(std::int64_t{1} << 61);
    file.add(raw_sample(bus::kSessionControl, control, kStart + 1, 3));
    recording::SampleReader reader(silent);
    std::uint64_t said = 0;
    while (auto sample = reader.next()) {
      recording::TopicSample copy;
      copy.topic = sample->topic;
      copy.writer[0] = 1;
      copy.received_time_ns = kStart + sample->received_time_ns;
      messages::shift_times(*sample->topic->type, kStart, sample->payload);
      copy.payload = sample->payload;
      file.add(copy);
      if (sample->topic->name != bus::kProbeState.name) continue;
      ProbeState wanted;
      const auto sim_ns = sample->received_time_ns;
      wanted.header = {++said, 0, kDay + sim_ns, 0};
      wanted.pose.position = {0, 0, 0.09 + 1e-10 * double(sim_ns)};
      file.add(raw_sample(bus::kProbeInput, wanted, copy.received_time_ns, 2));
    }
    HapticForce force;
    force.header = {1, 0, kDay, 0};
    file.add(raw_sample(bus::kHapticForce, force, kStart + 300'000'000, 4));
    file.close();
  }
  REQUIRE(rerun(run, {"haptics"}, again) == "");
  double highest = 0;
  std::int64_t last_ns = 0;
  recording::SampleReader reader(again);
  while (const auto sample = reader.next()) {
    ProbeState state;
    if (sample->topic->name != bus::kProbeState.name) continue;
    REQUIRE(messages::decode(sample->payload, state) == nullptr);
    highest = std::max(highest, state.pose.position.z());
    last_ns = state.header.sim_time_ns;
  }
  CHECK(highest == Approx(0.13).margin(2e-3));
  CHECK(last_ns < 1'000'000'000);
}

TEST_CASE("rerun: a time that no codec takes is not waited for") {
  // Oracle: the recording without such samples, and where it ends. The rerun of one in lockstep
  // said nothing behind the first of them, and never ended.
  using Limits = std::numeric_limits<std::int64_t>;
  const palpate::testing::BallScene scene(kPressAndSlide);
  const auto run = recorded(scene), again = scene.folder() / "again.mcap";
  const auto with_them = scene.folder() / "absurd.mcap";
  {
    auto file = recording::SampleFile::of_lockstep(with_them);
    recording::SampleReader reader(run);
    while (auto sample = reader.next()) {
      recording::TopicSample copy;
      copy.topic = sample->topic;
      copy.writer[0] = 1;
      copy.received_time_ns = sample->received_time_ns;
      copy.payload = sample->payload;
      file.add(copy);
      if (sample->topic->name != bus::kContacts.name) continue;
      HapticForce force;
      for (const std::int64_t absurd : {Limits::max(), messages::kMaxTimeNs + 1, Limits::min()}) {
        force.header = {1, 0, absurd, 0};
        file.add(recording::raw_sample(bus::kHapticForce, force, copy.received_time_ns, 2));
      }
    }
    file.close();
  }
  RunOptions options;
  options.record = again;
  options.duration = 1;
  Playing playing;
  playing.rerun = {"haptics"};
  std::ostringstream out, log;
  CHECK(replay_command(with_them, playing, options, out, log) == kExitDone);
  CHECK(log.str() == "palpate: the recording ends there, before the 1 s asked for\n");
  CHECK(recording::compare({run, again}).equal());
}
