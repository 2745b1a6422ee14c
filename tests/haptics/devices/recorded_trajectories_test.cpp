// The resampling on recordings of real surgical robots, jitter and gaps included.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "haptics/devices/trajectory.h"
#include "modules/core/rotation_vector.h"
#include "modules/trajectories/trajectory_file.h"

using namespace palpate;
using namespace palpate::haptics;

namespace {

std::filesystem::path recording(const std::string& name) {
  const char* folder = std::getenv("PALPATE_DATA");
  const std::filesystem::path data =
      folder ? folder : std::filesystem::path(PALPATE_SOURCE_DIR) / ".." / "shared" / "data";
  return data / "trajectories" / name;
}

double fastest(const std::vector<TimedPose>& samples) {
  double speed = 0;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const double step = samples[i + 1].time - samples[i].time;
    speed =
        std::max(speed, (samples[i + 1].pose.position - samples[i].pose.position).norm() / step);
  }
  return speed;
}

}  // namespace

TEST_CASE("recorded trajectories: load, pass through every sample, stay near recorded speeds") {
  // Oracle: measured data. Counts and gaps were taken from the files by an independent script;
  // the resampled speed may exceed the fastest recorded secant by the interpolant's bound of 1.5.
  const auto [name, rows, gaps, top_speed] =
      GENERATE(table<std::string, std::size_t, std::size_t, double>({
          {"palpation_presses_t3.csv", 15282, 2, 0.09660},
          {"palpation_scan_kidney.csv", 22144, 0, 0.010903},
          {"tool_200hz_freespace.csv", 5999, 0, 0.52640},
      }));
  if (!std::filesystem::exists(recording(name))) {
    std::cout << "SKIPPED: " << recording(name) << " is not there (set PALPATE_DATA)\n";
    return;
  }
  std::vector<std::string> warnings;
  const std::vector<TimedPose> samples =
      trajectories::read_trajectory({.file = recording(name)}, warnings);
  CHECK(samples.size() == rows);
  CHECK(warnings.size() == gaps);
  for (const std::string& warning : warnings) std::cout << warning << '\n';
  CHECK(fastest(samples) == Approx(top_speed).epsilon(1e-4));

  const Trajectory trajectory(samples, false);
  double worst_position = 0, worst_angle = 0;
  for (const TimedPose& sample : samples) {
    const Pose pose = trajectory.at(sample.time - samples.front().time).pose;
    const Quat turn = pose.rotation.conjugate() * sample.pose.rotation;
    worst_position = std::max(worst_position, (pose.position - sample.pose.position).norm());
    worst_angle = std::max(worst_angle, vector_from_rotation(turn).norm());
  }
  // Rounding of poses of order 1 and of times up to 346 s times the speeds.
  CHECK(worst_position < 1e-14);
  CHECK(worst_angle < 1e-13);

  double resampled_speed = 0, worst_length = 0;
  for (double t = 0; t < trajectory.duration(); t += 1e-3) {
    const DeviceSample at = trajectory.at(t);
    worst_length = std::max(worst_length, std::abs(at.pose.rotation.norm() - 1));
    resampled_speed = std::max(resampled_speed, at.twist.linear.norm());
  }
  CHECK(worst_length < 1e-15);
  std::cout << name << ": fastest recorded " << fastest(samples) << " m/s, resampled at 1 kHz "
            << resampled_speed << " m/s\n";
  CHECK(resampled_speed < 1.5 * fastest(samples));
  CHECK(resampled_speed > 0.95 * fastest(samples));
}
