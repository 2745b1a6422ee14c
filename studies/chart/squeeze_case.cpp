// The ball squeezed within a few hundredths of a second and held: forces over time.
#include <cmath>

#include "studies/chart/case_parts.h"
#include "studies/chart/reference_solutions.h"
#include "studies/rigs/squeezed_ball.h"

namespace palpate::chart {
namespace {

constexpr double kCompression = 0.2, kClosing = 0.06, kDuration = 0.3;  // [1], [s], [s]
/// What a force is the mean over: the longest period there is, for a period has no finer answer
/// [s].
constexpr double kWindow = 0.02;
constexpr double kSqueezeDrag = 10;  // [1/s]; no other damping: its laws differ between models

/// Height of the upper plate at `time` [s], above the middle [m].
double height_at(double time) {
  return rigs::kBallRadius * (1 - kCompression * std::min(1.0, time / kClosing));
}

}  // namespace

Measurement measure_squeeze(const Setting& setting, const KeepGoing& keep_going) {
  const auto shape = ball_shape(setting);
  scene::Scene scene = ball_scene(setting, kSqueezeDrag);
  scene.organs[0].tissue.damping_ratio = 0;
  auto poses = rigs::add_plates(scene);
  rigs::PressedOrgan pressed(scene, shape, poses);
  const int steps = static_cast<int>(std::lround(kWindow / pressed.period()));
  std::vector<Sample> samples;
  while (pressed.time() < kDuration - kWindow / 2 && !pressed.diverged()) {
    keep_going();
    double sum = 0;
    for (int k = 0; k < steps; ++k) {
      const double height = height_at(pressed.time() + pressed.period());
      poses[0].position.z() = height;
      poses[1].position.z() = -height;
      pressed.advance(poses);
      sum += (std::abs(pressed.force(0).z()) + std::abs(pressed.force(1).z())) / 2;
    }
    Sample& sample = samples.emplace_back();
    sample.load = kWindow * static_cast<double>(samples.size());
    sample.force = sum / steps;
  }
  Measurement result = summary(pressed, shape);
  result.is_course = true;
  result.samples = samples;
  return result;
}

Measurement squeeze_in_small_steps(int level, const KeepGoing& keep_going) {
  constexpr std::array kRates{1000.0, 2000.0};  // [Hz]
  return measure_squeeze({"quadratic_elements", 1, kRates[static_cast<std::size_t>(level)]},
                         keep_going);
}

}  // namespace palpate::chart
