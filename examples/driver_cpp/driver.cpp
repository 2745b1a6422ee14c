// A driver for a haptic device, on the bus of an installed Palpate.
// driver SESSION DOMAIN PROBE X Y Z: moves probe number PROBE of `palpate run … --session SESSION
// --domain DOMAIN`; X Y Z is where the device's own origin is in the scene [m].
#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>

#include "modules/bus/dds_bus.h"

namespace {

using palpate::Vec3;

constexpr double kRate = 1000;                     // of this loop, the device's [1/s]
constexpr std::int64_t kForceHolds = 100'000'000;  // [ns]
constexpr double kMaxForce = 3.3;                  // of the device [N]
constexpr std::int64_t kPeriod = static_cast<std::int64_t>(1e9 / kRate);  // [ns]

/// Stands in for your device: its handle goes 15 mm down and up again every 4 s, and nobody feels
/// its motors. Positions in metres from its own origin, axes as the scene's (z up).
class Device {
 public:
  Vec3 measured_cp(double time) const { return {0, 0, -0.0075 * (1 - std::cos(kOmega * time))}; }
  Vec3 measured_cv(double time) const { return {0, 0, -0.0075 * kOmega * std::sin(kOmega * time)}; }
  void servo_cf(const Vec3& force) { felt_ = std::max(felt_, force.norm()); }  // [N]
  double felt() const { return felt_; }

 private:
  static constexpr double kOmega = 2 * M_PI / 4;  // [rad/s]
  double felt_ = 0;                               // most so far [N]
};

std::atomic<bool> stop_wanted{false};
void want_stop(int) { stop_wanted = true; }

std::int64_t now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

/// (1) Absolute times: what a cycle takes does not add up.
void sleep_until(std::int64_t wake_ns) {
  const timespec wake{wake_ns / 1'000'000'000, wake_ns % 1'000'000'000};
  while (!stop_wanted && clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wake, nullptr) != 0) {
  }
}

/// What may reach the motors of what was heard `age` ago [ns].
Vec3 guarded(const Vec3& force, std::int64_t age) {
  if (age > kForceHolds) return Vec3::Zero();   // (2) nobody says it
  if (!force.allFinite()) return Vec3::Zero();  // (4) no force at all
  return force.norm() > kMaxForce ? Vec3(kMaxForce * force.normalized()) : force;  // (3)
}

void drive(const palpate::bus::BusOptions& session, std::uint32_t probe, const Vec3& origin) {
  palpate::bus::DdsBus bus(session);
  auto poses = bus.writer(palpate::bus::kProbeInput);
  auto forces = bus.reader(palpate::bus::kHapticForce);
  Device device;
  palpate::ProbeState state;
  palpate::HapticForce newest, force;
  const std::int64_t began = now_ns();
  std::int64_t next = began, heard = began, samples = 0;
  while (!stop_wanted) {
    sleep_until(next);
    const std::int64_t now = now_ns();
    next += std::max<std::int64_t>(1, (now - next) / kPeriod + 1) * kPeriod;  // (1) late: skip

    while (forces.take(newest)) {
      if (newest.probe != probe) continue;
      force = newest;
      heard = now;
      ++samples;
    }
    device.servo_cf(guarded(force.force, now - heard));

    const double time = 1e-9 * static_cast<double>(now - began);
    state.probe = probe;
    state.header.source_time_ns = now;  // when it was measured, CLOCK_MONOTONIC
    state.pose.position = origin + device.measured_cp(time);
    state.twist.linear = device.measured_cv(time);
    poses.write(state);
  }
  device.servo_cf(Vec3::Zero());  // (5)
  std::printf("driver: %lld forces heard, at most %.3f N\n", static_cast<long long>(samples),
              device.felt());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) {
    std::fprintf(stderr, "usage: driver SESSION DOMAIN PROBE X Y Z\n");
    return 2;
  }
  std::signal(SIGINT, want_stop);
  std::signal(SIGTERM, want_stop);
  try {
    const palpate::bus::BusOptions session{.domain = std::atoi(argv[2]), .session = argv[1]};
    drive(session, static_cast<std::uint32_t>(std::atoi(argv[3])),
          Vec3(std::atof(argv[4]), std::atof(argv[5]), std::atof(argv[6])));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "driver: %s\n", error.what());
    return 1;
  }
  return 0;
}
