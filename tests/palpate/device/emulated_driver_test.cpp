#include "palpate/device/emulated_driver.h"

#include <catch2/catch.hpp>

#include "modules/bus/memory_bus.h"
#include "tests/times.h"

using namespace palpate;
using launcher::EmulatedDriver;

namespace {

/// A driver of probe 1 at 1 kHz, and the haptic process in the test's hands.
struct Attached {
  bus::MemoryBus bus;
  bus::Writer<HapticForce> forces = bus.writer(bus::kHapticForce);
  bus::Reader<ProbeState> poses = bus.reader(bus::kProbeInput);
  EmulatedDriver driver;
  std::int64_t now_ns = 7'000 * kMs;
  ProbeState said;

  explicit Attached(const scene::EmulatedDevice& config) : driver(config, 1, bus) {}

  void push(const Vec3& force, std::uint32_t probe = 1, std::uint32_t limits = 0) {
    HapticForce message;
    message.limits = limits;
    message.header.source_time_ns = now_ns;
    message.probe = probe;
    message.force = force;
    REQUIRE(forces.write(message));
  }
  /// The next period.
  void cycle(std::optional<std::int64_t> period) {
    now_ns += kMs;
    driver.cycle(now_ns, period);
    REQUIRE(poses.take(said));
    CHECK(said.probe == 1);
  }
};

scene::EmulatedDevice config_at(const Vec3& start) {
  scene::EmulatedDevice config;
  config.start = start;
  config.encoder_step = 0;
  return config;
}

}  // namespace

TEST_CASE("emulated driver: it is felt where haptics renders its probe and does not miss it") {
  // Oracle: definition. A force is not known to hold for longer than the driver's own 0.1 s.
  Attached attached(config_at(Vec3::Zero()));
  const auto felt = [&] {
    attached.cycle(std::nullopt);
    return attached.driver.is_felt(attached.now_ns);
  };
  CHECK_FALSE(felt());
  attached.push(Vec3::Zero(), 0);  // another probe
  CHECK_FALSE(felt());
  attached.push(Vec3::Zero(), 1, kDriverSilent);
  CHECK_FALSE(felt());
  attached.push(Vec3::Zero(), 1, kForceSaturated);
  CHECK(felt());
  for (int i = 0; i < 100; ++i) CHECK(felt());
  CHECK_FALSE(felt());
}

TEST_CASE("emulated driver: until a hand takes the device it says where that stands") {
  // Oracle: definition.
  auto config = config_at(Vec3(0.1, 0.2, 0.3));
  config.hand.push = Vec3(0, 0, -1);
  Attached attached(config);
  for (int i = 0; i < 50; ++i) {
    attached.cycle(std::nullopt);
    CHECK(attached.said.pose.position == config.start);
    CHECK(attached.said.header.source_time_ns == attached.now_ns);
  }
  for (int i = 0; i <= 100; ++i) attached.cycle(i);
  CHECK(attached.said.pose.position.z() < 0.3 - 1e-3);
  CHECK(attached.said.twist.linear.z() < 0);
}

TEST_CASE("emulated driver: the force of its own probe moves the body, from the next period on") {
  // Oracle: analytic, f T²/2m over the first period that holds it.
  auto config = config_at(Vec3::Zero());
  config.damping = 0;
  Attached attached(config);
  attached.cycle(0);
  attached.push(Vec3(3, 0, 0), 0);  // of another probe
  attached.push(Vec3(0, 1, 0));
  attached.cycle(1);
  CHECK(attached.driver.device().position().norm() == 0);
  attached.cycle(2);
  CHECK(attached.driver.device().position().x() == 0);
  CHECK(attached.driver.device().position().y() == Approx(1e-6 / (2 * 0.1)));
}

TEST_CASE("emulated driver: a force that nobody repeats is let go of") {
  // Oracle: the guard's time.
  Attached attached(config_at(Vec3::Zero()));
  attached.cycle(0);
  attached.push(Vec3(0, 1, 0));
  const auto holds = static_cast<int>(1e3 * EmulatedDriver::kForceHolds);
  for (int i = 1; i <= holds + 3; ++i) {
    attached.cycle(i);
    const double force = attached.driver.device().motor_force().y();
    if (i > 1 && i <= holds + 1) CHECK(force == 1);
    if (i == holds + 3) CHECK(force == 0);
  }
}

TEST_CASE("emulated driver: a reading is stamped with when it was taken, not when it arrived") {
  // Oracle: definition; 3 ms on its way.
  auto config = config_at(Vec3::Zero());
  config.transport_delay = 3e-3;
  Attached attached(config);
  attached.cycle(0);
  CHECK(attached.said.header.source_time_ns == attached.now_ns - 3 * kMs);
}

TEST_CASE("emulated driver: late by some periods, it is where time has taken the body") {
  // Oracle: one that was never late, bit for bit.
  auto config = config_at(Vec3::Zero());
  config.hand.push = Vec3(0.1, 0, 0);
  Attached steady(config), late(config);
  for (int i = 0; i <= 40; ++i) {
    steady.cycle(i);
    if (i % 7 == 0) late.cycle(i);
  }
  CHECK(steady.driver.device().position() != Vec3::Zero());
  late.cycle(40);
  CHECK(steady.driver.device().position() == late.driver.device().position());
}
