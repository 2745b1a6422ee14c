#include "modules/recording/foxglove_export.h"

#include <catch2/catch.hpp>
#include <iostream>

#include "modules/core/error.h"
#include "modules/recording/diff.h"
#include "modules/recording/inspect.h"
#include "tests/file_size_limit.h"
#include "tests/modules/recording/node_judge.h"
#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

/// One second: two probes at 100 Hz, which feel forces, and a tetrahedron that moves at 50 Hz.
void write_touched_tetrahedron(const std::filesystem::path& file) {
  SampleFile writer(file, {.domain = 0, .session = "touched"}, {0, 1'700'000'000'000'000'000});
  SurfaceTopology surface;
  surface.header = {1, 0, 1};
  surface.generation = 3;
  surface.name = "drop";
  surface.surface_node_count = 4;
  surface.rest_positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.1f, 0.1f, 0.1f};
  surface.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  writer.add(raw_sample(bus::kSurface, surface, 1'000));
  SceneDescription scene;
  scene.header = {1, 0, 1};
  scene.name = "other version";
  scene.digest = "1234567812345678";
  scene.resolved_text = "organs: [";
  writer.add(raw_sample(bus::kScene, scene, 1'500));
  for (std::uint64_t i = 1; i <= 100; ++i) {
    const std::int64_t now = 10'000'000 * std::int64_t(i);
    for (std::uint32_t probe = 0; probe < 2; ++probe) {
      ProbeState state =
          probe_state(2 * i + probe, now, probe, {0.1 * double(i), -1.0 / double(i), 0.3});
      state.pose.rotation = Quat(Eigen::AngleAxisd(0.01 * double(i), Vec3::UnitY()));
      writer.add(raw_sample(bus::kProbeState, state, now));
      HapticForce force;
      force.header = {2 * i + probe, now, 1};
      force.probe = probe;
      if (probe == 1) force.force = {0.01 * double(i), -0.7, std::sqrt(double(i))};
      force.torque = {1e-3 / double(i), 0, -2e-3};
      writer.add(raw_sample(bus::kHapticForce, force, now + 1'000));
    }
    if (i % 2 != 0) continue;
    NodePositions nodes = node_positions(i / 2, 1.0 / 6, 5);
    nodes.generation = i < 90 ? 3 : 4;  // of a surface that was not heard of
    nodes.positions = surface.rest_positions;
    for (float& x : nodes.positions) x += 0.001f * static_cast<float>(i);
    writer.add(raw_sample(bus::kNodePositions, nodes, now + 2'000));
  }
  writer.close();
}

}  // namespace

TEST_CASE(
    "foxglove export: schemas are those published, numbers those of the samples beside them") {
  // Oracle: @foxglove/schemas for the types; @mcap/core and @foxglove/omgidl-serialization decode
  // samples and translations, each by its own schema. Counts by hand: all poses and wrenches;
  // pictures at no more than 30 a second, one in each thirtieth that holds a sample.
  const std::string modules = testing::node_modules();
  if (modules.empty()) {
    std::cout << testing::kNoNode;
    return;
  }
  const ScratchFolder folder;
  write_touched_tetrahedron(folder / "a.mcap");
  const FoxgloveReport report = export_to_foxglove(folder / "a.mcap", folder / "f.mcap");
  CHECK(report.samples == 2 + 4 * 100 + 50);
  const std::string output = testing::judged_by("read_foxglove.mjs", folder / "f.mcap", modules);
  INFO(output);
  using Catch::Contains;
  for (const char* type : {"PoseInFrame", "FrameTransform", "SceneUpdate"}) {
    CHECK_THAT(output,
               Contains("schema foxglove::" + std::string(type) + " omgidl as published\n"));
  }
  for (const char* probe : {"/probe_0", "/probe_1"}) {
    CHECK_THAT(output, Contains(std::string(probe) + "/pose 100 equal\n"));
    CHECK_THAT(output, Contains(std::string(probe) + "/wrench 100 equal\n"));
  }
  // 0.01 s … 1.00 s touch the thirtieths 0 … 30, 0.02 s … 0.88 s those from 0 to 26 of the surface.
  CHECK_THAT(output, Contains("/tf 62 equal\n"));
  CHECK_THAT(output, Contains("/organ_0/surface 27 equal\n"));
  CHECK_THAT(output, Contains("/probe_1/force 31 equal\n"));
  CHECK_THAT(output, Contains("/probe_0/force none 31 equal\n"));
  CHECK_THAT(output, Contains("time ") && !Contains("differ"));
}

TEST_CASE("foxglove export: what it writes is still the recording") {
  // Oracle: `diff`, which compares bytes; the summary of the original.
  const ScratchFolder folder;
  write_touched_tetrahedron(folder / "a.mcap");
  const FoxgloveReport report = export_to_foxglove(folder / "a.mcap", folder / "f.mcap");
  CHECK(compare({folder / "a.mcap", folder / "f.mcap"}).equal());
  const RecordingSummary before = summarize(folder / "a.mcap"),
                         after = summarize(folder / "f.mcap");
  CHECK(after.session == before.session);
  CHECK(after.first_ns == before.first_ns);
  CHECK(after.topics.size() == before.topics.size());
  REQUIRE(report.warnings.size() == 1);  // the text is no scene
  CHECK_THAT(report.warnings.front(), Catch::StartsWith("the shape of probe_0 is not shown: "));
}

TEST_CASE("foxglove export: replaces nothing, and leaves nothing of what is no recording") {
  // Oracle: the rule in foxglove_export.h.
  const ScratchFolder folder;
  write_touched_tetrahedron(folder / "a.mcap");
  CHECK_THROWS_AS(export_to_foxglove(folder / "a.mcap", folder / "a.mcap"), InputError);
  write_bytes(folder / "b.mcap", {1, 2, 3});
  CHECK_THROWS_AS(export_to_foxglove(folder / "b.mcap", folder / "f.mcap"), InputError);
  CHECK_FALSE(std::filesystem::exists(folder / "f.mcap"));
}

TEST_CASE("foxglove export: a full disk leaves nothing that would refuse the next try") {
  // Oracle: the folder; a limit on the size of files fails where a full disk does.
  const ScratchFolder folder;
  write_touched_tetrahedron(folder / "a.mcap");
  {
    const FileSizeLimit limit(600);
    CHECK_THROWS_WITH(export_to_foxglove(folder / "a.mcap", folder / "f.mcap"),
                      Catch::StartsWith((folder / "f.mcap").string() + ": cannot write: "));
  }
  CHECK(folder.file_count() == 1);
  CHECK_NOTHROW(export_to_foxglove(folder / "a.mcap", folder / "f.mcap"));
  CHECK(folder.file_count() == 2);
}

}  // namespace palpate::recording
