// The haptic loop's body allocates nothing: every operator new of its thread is counted.
#include <catch2/catch.hpp>

#include "haptics/devices/device.h"
#include "haptics/haptic_renderer.h"
#include "tests/counted_allocations.h"
#include "tests/haptics/wall_law.h"
#include "tests/scratch_folder.h"

using namespace palpate;
using namespace palpate::haptics;
using palpate::testing::allocations;

namespace {

/// Allocations of 10,000 ticks of `device` and a renderer fed at 250 Hz, bad models among them.
std::size_t allocations_of_ticks(Device& device) {
  HapticRenderer renderer({}, 1e-3);
  auto* outside = dynamic_cast<OutsideDevice*>(&device);
  LocalLaw model = testing::wall_law(Vec3(0, 0, -0.005), 200);
  model.rows.resize(kMaxLawRows, model.rows[0]);
  model.compliance.clear();
  for (std::size_t i = 0; i < kMaxLawRows; ++i) {
    for (std::size_t j = 0; j <= i; ++j) model.compliance.push_back(i == j ? 0.005 : 0.001);
  }
  LocalLaw few = testing::wall_law(Vec3(0, 0, -0.005), 200);
  DeviceSample said;
  RenderedForce out;
  const std::size_t before = allocations();
  for (int i = 0; i < 10'000; ++i) {
    const double time = 1e-3 * i;
    model.anchor.position = Vec3(0, 0, 1e-4 * (i % 100));
    model.rows[0].force.x() = i % 500 == 0 ? std::nan("") : 0;
    LocalLaw& law = i % 3 == 0 ? few : model;  // of other sizes in turn
    law.anchor = model.anchor;
    if (i % 4 == 0 && i % 2000 < 1000) renderer.update_law(law, time);  // stale in between
    said.pose.position.z() = 1e-4 * (i % 100);
    const std::int64_t now_ns = std::int64_t{1'000'000} * i;
    if (outside && i % 16 == 0 && i % 3000 < 2000) outside->hear(said, now_ns, now_ns);
    renderer.tick(time, device.read(time), out);
    device.feel(out);
  }
  return allocations() - before;
}

}  // namespace

TEST_CASE("allocation: the counter counts") {
  // Oracle: one allocation made on purpose.
  const std::size_t before = allocations();
  void* memory = ::operator new(10);
  ::operator delete(memory);
  CHECK(allocations() == before + 1);
}

TEST_CASE("allocation: 10,000 ticks of each device allocate nothing") {
  // Oracle: counting.
  const ScratchFolder folder;
  const auto file = folder.write("short.csv",
                                 "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n0.05,0,0,0.01,0,0,1,0\n"
                                 "0.1,0,0,0.02,0,0,0,1\n");
  scene::TrajectoryDevice trajectory;
  trajectory.file = file;
  trajectory.loop = true;
  scene::ScriptedDevice script;
  script.moves = {{Vec3(0, 0, 0.01), 2.0}, {std::nullopt, 1.0}, {Vec3(0, 0, 0), 2.0}};
  std::vector<std::string> warnings;
  CHECK(allocations_of_ticks(*make_device(trajectory, {}, warnings)) == 0);
  CHECK(allocations_of_ticks(*make_device(script, {}, warnings)) == 0);
  CHECK(allocations_of_ticks(*make_device(scene::TopicDevice{}, {}, warnings)) == 0);
  CHECK(allocations_of_ticks(*make_device(scene::MouseDevice{}, {}, warnings)) == 0);
  CHECK(allocations_of_ticks(*make_device(scene::EmulatedDevice{}, {}, warnings)) == 0);
}
