// The haptic loop's body allocates nothing: every operator new of this program is counted.
#include <atomic>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <new>

#include "haptics/device.h"
#include "haptics/haptic_renderer.h"
#include "tests/haptics/temporary_file.h"

namespace {

std::atomic<long> allocations = 0;

void* counted(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}

void* counted_aligned(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto align = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(align, (size + align - 1) / align * align)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void* operator new(std::size_t size, std::align_val_t align) {
  return counted_aligned(size, align);
}
void* operator new[](std::size_t size, std::align_val_t align) {
  return counted_aligned(size, align);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size ? size : 1);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size ? size : 1);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }

using namespace palpate;
using namespace palpate::haptics;

namespace {

/// Allocations of 10,000 ticks of `device` and a renderer fed at 250 Hz, bad models among them.
long allocations_of_ticks(Device& device) {
  HapticRenderer renderer({}, 1e-3);
  auto* topic = dynamic_cast<TopicDevice*>(&device);
  LocalLaw model;
  model.touching = true;
  model.force = Vec3(0, 0, 1);
  model.stiffness = 200 * Mat3::Identity();
  model.validity_radius = 0.01;
  Pose commanded;
  RenderedForce out;
  const long before = allocations;
  for (int i = 0; i < 10'000; ++i) {
    const double time = 1e-3 * i;
    model.anchor = Vec3(0, 0, 1e-4 * (i % 100));
    model.force.x() = i % 500 == 0 ? std::nan("") : 0;
    if (i % 4 == 0 && i % 2000 < 1000) renderer.update_law(model, time);  // stale in between
    commanded.position.z() = 1e-4 * (i % 100);
    if (topic && i % 16 == 0) topic->command(commanded, 0);
    renderer.tick(time, device.read(time), out);
  }
  return allocations - before;
}

}  // namespace

TEST_CASE("allocation: the counter counts") {
  // Oracle: one allocation made on purpose.
  const long before = allocations;
  void* memory = ::operator new(10);
  ::operator delete(memory);
  CHECK(allocations == before + 1);
}

TEST_CASE("allocation: 10,000 ticks of each device allocate nothing") {
  // Oracle: counting.
  const TemporaryFile file("short.csv",
                           "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n0.05,0,0,0.01,0,0,1,0\n"
                           "0.1,0,0,0.02,0,0,0,1\n");
  scene::TrajectoryDevice trajectory;
  trajectory.file = file.path();
  trajectory.loop = true;
  scene::ScriptedDevice script;
  script.moves = {{Vec3(0, 0, 0.01), 2.0}, {std::nullopt, 1.0}, {Vec3(0, 0, 0), 2.0}};
  std::vector<std::string> warnings;
  CHECK(allocations_of_ticks(*make_device(trajectory, warnings)) == 0);
  CHECK(allocations_of_ticks(*make_device(script, warnings)) == 0);
  CHECK(allocations_of_ticks(*make_device(scene::TopicDevice{}, warnings)) == 0);
}
