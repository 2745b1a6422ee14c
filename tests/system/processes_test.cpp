// Organs in several deformation processes, over DDS with the real processes, beside the same
// session in one.
#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <map>

#include "modules/recording/sample_reader.h"
#include "tests/palpate/two_balls_scene.h"
#include "tests/system/launched.h"

using namespace palpate;
using namespace palpate::testing;

namespace {

constexpr double kSplitRunDeadline = 100;  // [s]; a run takes about one

std::string file_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Every payload of each topic, in order.
std::map<std::string, std::vector<std::vector<std::uint8_t>>> payloads(
    const std::filesystem::path& recording) {
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> of;
  recording::SampleReader reader(recording);
  while (const auto sample = reader.next()) {
    of[std::string(sample->topic->name)].push_back(sample->payload);
  }
  return of;
}

/// The last force on each probe of a recording.
std::map<std::uint32_t, Vec3> last_forces(const std::filesystem::path& recording) {
  std::map<std::uint32_t, Vec3> forces;
  recording::SampleReader reader(recording);
  messages::AnyMessage message;
  while (const auto sample = reader.next()) {
    REQUIRE(sample->topic->type->decode(sample->payload, message) == nullptr);
    if (const auto* force = std::get_if<HapticForce>(&message)) forces[force->probe] = force->force;
  }
  return forces;
}

/// How many processes' last law of a probe presses.
std::size_t laws_that_press(const std::filesystem::path& recording, std::uint32_t probe) {
  std::map<std::uint32_t, bool> presses;  // by process
  recording::SampleReader reader(recording);
  messages::AnyMessage message;
  while (const auto sample = reader.next()) {
    REQUIRE(sample->topic->type->decode(sample->payload, message) == nullptr);
    const auto* law = std::get_if<ContactModel>(&message);
    if (law != nullptr && law->probe == probe) presses[law->process] = law->touching();
  }
  return static_cast<std::size_t>(
      std::count_if(presses.begin(), presses.end(), [](const auto& p) { return p.second; }));
}

}  // namespace

TEST_CASE("processes: two leave the bytes in lockstep that one leaves, and the organs one knows") {
  // Oracle: the session in one process, byte for byte; and of the same organs without the key all
  // that is said of organs, probes and forces, bit for bit. A probe that touches organs of both has
  // two laws instead of one: of it the tissue's own force at rest.
  const std::string between = press_from(0.065, kBallsApart / 2);
  const TwoBallsScene apart("2", between), together("", between);
  const auto split = apart.folder() / "split.mcap", inside = apart.folder() / "inside.mcap",
             one = apart.folder() / "one.mcap";
  const auto with = [&](const char* how, const std::filesystem::path& file) {
    return std::vector<std::string>{how, "--duration", "1", "--record", file.string()};
  };
  Launched lockstep(apart.file(), with("--lockstep", split));
  REQUIRE(lockstep.wait_for_end(kSplitRunDeadline) == 0);
  CHECK(lockstep.said().find("deformation_2 250 cycles") != std::string::npos);
  REQUIRE(Launched(apart.file(), with("--in-process", inside)).wait_for_end(kSplitRunDeadline) ==
          0);
  CHECK(file_bytes(split) == file_bytes(inside));

  REQUIRE(Launched(together.file(), with("--lockstep", one)).wait_for_end(kSplitRunDeadline) == 0);
  auto a = payloads(split), b = payloads(one);
  REQUIRE(a["node_positions"].size() == 500);
  for (const char* topic : {"surface", "node_positions", "probe_state", "contacts"}) {
    INFO(topic);
    CHECK(a[topic] == b[topic]);
  }
  CHECK(a["contact_model"].size() == 2 * b["contact_model"].size());
  const auto forces = last_forces(split), expected = last_forces(one);
  for (const std::uint32_t probe : {0u, 1u}) CHECK(forces.at(probe) == expected.at(probe));
  CHECK(laws_that_press(split, 2) == 2);
  CHECK(laws_that_press(one, 2) == 1);
  CHECK(expected.at(2).z() > 0);
  CHECK((forces.at(2) - expected.at(2)).norm() < 0.01 * expected.at(2).norm());
}

TEST_CASE("processes: in real time both run, and the summary tells of each") {
  // Oracle: the summary's lines; all forces in both balls' recordings are there.
  const TwoBallsScene apart("2");
  Launched run(apart.file(), {"--duration", "1.5"});
  REQUIRE(run.wait_for_end(kSplitRunDeadline) == 0);
  for (const char* name : {"deformation  ", "deformation_2 ", "collision ", "haptics "}) {
    INFO(name);
    CHECK(run.said().find(name) != std::string::npos);
  }
  CHECK(run.said().find("FAILED") == std::string::npos);
  Launched none(apart.file(), {"--only", "deformation_3"});
  CHECK(none.wait_for_end(kSplitRunDeadline) == 2);
  CHECK(none.said().find("there are deformation, deformation_2, collision, haptics, visualizer") !=
        std::string::npos);
}
