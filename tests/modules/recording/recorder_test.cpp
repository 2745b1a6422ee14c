#include "modules/recording/recorder.h"

#include <sys/resource.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "modules/recording/sample_reader.h"
#include "modules/scene/scene_reader.h"
#include "tests/modules/bus/loopback.h"
#include "tests/modules/messages/random_messages.h"
#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

using bus::testing::own_options;
using bus::testing::wait_until;

// Payloads of a recording by topic, in order.
std::map<std::string_view, std::vector<std::vector<std::uint8_t>>> payloads_of(
    SampleReader& reader) {
  std::map<std::string_view, std::vector<std::vector<std::uint8_t>>> payloads;
  while (auto sample = reader.next()) payloads[sample->topic->name].push_back(sample->payload);
  return payloads;
}

}  // namespace

TEST_CASE("recorder: writes every sample of a session, byte for byte") {
  // Oracle: the codec's bytes of the messages that were sent.
  constexpr int kSamples = 60;
  const ScratchFolder folder;
  const auto options = own_options();
  messages::testing::Random random(5);
  bus::DdsBus bus(options);
  auto scenes = bus.writer(bus::kScene);
  SceneDescription scene;
  scene.name = "ball";
  scene.digest = "0123456789abcdef";
  scene.header.source_time_ns = 7;
  REQUIRE(scenes.write(scene));  // before the recorder exists: a late joiner gets it

  bus::DdsBus recorder_bus(options);
  Recorder recorder(recorder_bus, options, folder / "live.mcap");
  auto probes = bus.writer(bus::kProbeState);
  auto nodes = bus.writer(bus::kNodePositions);
  REQUIRE(wait_until([&] { return recorder.matched_writers() == 3; }));
  REQUIRE(
      wait_until([&] { return probes.matched_readers() == 1 && nodes.matched_readers() == 1; }));
  std::vector<std::vector<std::uint8_t>> sent_probes, sent_nodes;
  for (int i = 0; i < kSamples; ++i) {
    auto state = messages::testing::random_message<ProbeState>(random);
    REQUIRE(probes.write(state));
    sent_probes.push_back(cdr_of(state));
    if (i % 4 != 0) continue;
    auto positions = node_positions(0, 1e-3, i);
    REQUIRE(nodes.write(positions));
    sent_nodes.push_back(cdr_of(positions));
    recorder.poll();
  }
  const std::uint64_t expected = 1 + sent_probes.size() + sent_nodes.size();
  REQUIRE(wait_until([&] {
    recorder.poll();
    return recorder.samples_written() >= expected;
  }));
  recorder.close();

  SampleReader reader(folder / "live.mcap");
  auto payloads = payloads_of(reader);
  CHECK_FALSE(reader.torn());
  REQUIRE(payloads["scene"].size() == 1);
  CHECK(payloads["scene"][0] == cdr_of(scene));
  CHECK(payloads["probe_state"] == sent_probes);
  CHECK(payloads["node_positions"] == sent_nodes);
  CHECK(reader.metadata(kSceneMetadata) ==
        McapMap{{"name", "ball"}, {"digest", "0123456789abcdef"}});
}

TEST_CASE("recorder: the file says which session it is of and how its clock relates to the day") {
  // Oracle: the options given; both clocks read around the recorder's start.
  const ScratchFolder folder;
  bus::BusOptions session;
  session.session = "ward_3";
  session.domain = 12;
  const auto unix_ns = [] {
    return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  };
  const auto before = unix_ns();
  SampleFile(folder / "a.mcap", session).close();
  SampleReader reader(folder / "a.mcap");
  CHECK_FALSE(reader.next());
  const McapMap metadata = reader.metadata(kSessionMetadata);
  CHECK(metadata.at("session") == "ward_3");
  CHECK(metadata.at("topics") == "all");
  CHECK(metadata.at("domain") == "12");
  CHECK(metadata.at("protocol_version") == std::to_string(kProtocolVersion));
  CHECK(std::stoll(metadata.at("start_unix_ns")) >= before);
  CHECK(std::stoll(metadata.at("start_unix_ns")) <= unix_ns());
  CHECK(std::stoll(metadata.at("start_monotonic_ns")) > 0);
  CHECK(reader.metadata(kSceneMetadata).empty());
}

TEST_CASE("recorder: message records carry the time of day of receipt and source, and sequence") {
  // Oracle: the values given; read back, they are of the monotonic clock again.
  const ScratchFolder folder;
  SampleFile file(folder / "a.mcap", {}, {500, 70'000});
  ProbeState state = probe_state(41, 5, 0, Vec3::Zero());
  state.header.source_time_ns = 900;
  file.add(raw_sample(bus::kProbeState, state, 1000));
  file.close();
  McapReader reader(folder / "a.mcap");
  std::optional<McapMessage> message;
  while (const auto record = reader.next()) {
    if (std::holds_alternative<McapMessage>(*record)) message = std::get<McapMessage>(*record);
  }
  REQUIRE(message);
  CHECK(message->sequence == 41);
  CHECK(message->log_time_ns == 70'500);
  CHECK(message->publish_time_ns == 70'400);
  SampleReader samples(folder / "a.mcap");
  CHECK(samples.next()->received_time_ns == 1000);
}

TEST_CASE("recorder: the scene is noted once, and again when another is loaded") {
  // Oracle: counted metadata records.
  const ScratchFolder folder;
  SampleFile file(folder / "a.mcap", {});
  SceneDescription scene;
  scene.name = "ball";
  scene.header = {1, 0, 1};
  for (const char* digest : {"a", "a", "b"}) {
    scene.digest = digest;
    file.add(raw_sample(bus::kScene, scene, 1));
  }
  CHECK(file.statistics().metadata_count == 3);  // with the session's
  CHECK(file.statistics().message_count == 3);
}

TEST_CASE("recorder: the scene, and the meshes and motions it names, lie in the file") {
  // Oracle: the resolved text, and the files' own bytes.
  const ScratchFolder folder;
  const std::filesystem::path file = PALPATE_SOURCE_DIR "/scenes/liver_probe.yaml";
  SceneDescription scene;
  scene.header = {1, 0, 1};
  scene.digest = "0123456789abcdef";
  scene.resolved_text = scene::resolved_text(scene::load_scene(file));
  SampleFile recording(folder / "a.mcap", {});
  recording.add(raw_sample(bus::kScene, scene, 1));
  recording.close();
  McapReader reader(folder / "a.mcap");
  std::map<std::string, std::string> attached;
  while (const auto record = reader.next()) {
    if (const auto* attachment = std::get_if<McapAttachment>(&*record)) {
      attached[attachment->name] = attachment->data;
    }
  }
  const auto mesh = bytes_of(PALPATE_SOURCE_DIR "/scenes/meshes/liver.ply");
  const auto motion = bytes_of(PALPATE_SOURCE_DIR "/scenes/trajectories/press_slide.csv");
  REQUIRE(attached.size() == 3);
  CHECK(attached["scene.yaml"] == scene.resolved_text);
  CHECK(attached["liver.ply"] == std::string(mesh.begin(), mesh.end()));
  CHECK(attached["press_slide.csv"] == std::string(motion.begin(), motion.end()));
}

TEST_CASE("recorder: a file that cannot be opened is left out, and nothing else") {
  // Oracle: the file; a limit on open files stands for whatever fails.
  const ScratchFolder folder;
  SceneDescription scene;
  scene.header = {1, 0, 1};
  scene.digest = "0123456789abcdef";
  scene.resolved_text = "file: \"" + folder.write("a.ply", "ply\n").string() + "\"\n";
  SampleFile recording(folder / "a.mcap", {});
  rlimit before{};
  ::getrlimit(RLIMIT_NOFILE, &before);
  const rlimit none{3, before.rlim_max};
  ::setrlimit(RLIMIT_NOFILE, &none);
  CHECK_NOTHROW(recording.add(raw_sample(bus::kScene, scene, 1)));
  ::setrlimit(RLIMIT_NOFILE, &before);
  recording.close();
  McapReader reader(folder / "a.mcap");
  std::vector<std::string> attached;
  while (const auto record = reader.next()) {
    const auto* attachment = std::get_if<McapAttachment>(&*record);
    if (attachment != nullptr) attached.push_back(attachment->name);
  }
  CHECK(attached == std::vector<std::string>{"scene.yaml"});
}

TEST_CASE("recorder: what was not asked for is left out, what was lost is counted all the same") {
  // Oracle: 250 positions in a second, numbers 51 to 60 missing, at most 20 a second: at 5 times in
  // each of 20 periods; the summary does not take what was left out for missing.
  const ScratchFolder folder;
  SampleFile file(folder / "a.mcap", {}, Clocks::now(), TopicSelection({"node_positions=20"}));
  for (std::uint64_t i = 1; i <= 250; ++i) {
    const auto time_ns = static_cast<std::int64_t>(4'000'000 * (i - 1));
    if (i > 50 && i <= 60) continue;
    file.add(raw_sample(bus::kNodePositions, node_positions(i, 1e-3, 0), time_ns));
    file.add(raw_sample(bus::kHapticForce, HapticForce{}, time_ns));
  }
  file.close();
  CHECK(file.lost() == 10);
  CHECK(file.statistics().message_count == 20);
  SampleReader reader(folder / "a.mcap");
  int count = 0;
  for (; const auto sample = reader.next(); ++count) CHECK(sample->thinned);
  CHECK(count == 20);
}

TEST_CASE("recorder: what comes late is not lost") {
  // Oracle: all numbers from 1 to 100 are there, every tenth behind the three after it.
  const ScratchFolder folder;
  SampleFile file(folder / "a.mcap", {});
  std::vector<std::uint64_t> numbers;
  for (std::uint64_t i = 1; i <= 100; ++i) numbers.push_back(i);
  for (std::size_t i = 9; i + 3 < 100; i += 10) {
    std::rotate(numbers.begin() + std::ptrdiff_t(i), numbers.begin() + std::ptrdiff_t(i) + 1,
                numbers.begin() + std::ptrdiff_t(i) + 4);
  }
  for (const std::uint64_t i : numbers) {
    file.add(raw_sample(bus::kNodePositions, node_positions(i, 1e-3, 0), 1'000'000));
  }
  file.close();
  CHECK(file.lost() == 0);
}

TEST_CASE("recorder: a full disk is reported") {
  // Oracle: the kernel's device that is always full.
  const auto options = own_options();
  bus::DdsBus bus(options);
  CHECK_THROWS_WITH(Recorder(bus, options, "/dev/full"),
                    "/dev/full: cannot write: No space left on device");
}

}  // namespace palpate::recording
