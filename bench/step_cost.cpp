// What one deformation step costs, and which part of it the volume constraint takes.
//
//   palpate-bench-step-cost SCENE…
//
// For the first organ of each scene: the same step with the constraint on and off, in turn, so
// that a machine whose speed drifts slows both. Prints medians over the pairs.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "deformation/symplectic_euler.h"
#include "modules/core/error.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"

namespace {

using namespace palpate;

constexpr int kPairs = 31;

/// Wall seconds of one step, mean over `steps` steps of a gently swinging organ.
double seconds_per_step(const deformation::OrganModel& model, double h, int steps) {
  auto state = deformation::rest_state(model);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3& p = state.positions[i];
    if (model.inverse_masses[i] > 0) state.velocities[i] = Vec3(p.z(), 0, p.x());
  }
  deformation::StepBuffers buffers;
  deformation::symplectic_euler_step(model, h, {}, state, buffers);
  const auto start = std::chrono::steady_clock::now();
  for (int s = 0; s < steps; ++s) {
    deformation::symplectic_euler_step(model, h, {}, state, buffers);
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return elapsed.count() / steps;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void measure(const char* file) {
  const auto scene = scene::load_scene(file);
  const auto surface = scene::load_organ(scene.organs[0]);
  auto model = deformation::build_organ_model(scene.organs[0], scene.gravity, surface);
  const double h = 0.9 * deformation::stable_step_bound(model);
  const int steps = std::max(2, static_cast<int>(200'000 / model.node_count()));
  std::vector<double> with, share;
  for (int pair = 0; pair < kPairs; ++pair) {
    model.preserve_volume = true;
    const double on = seconds_per_step(model, h, steps);
    model.preserve_volume = false;
    const double off = seconds_per_step(model, h, steps);
    with.push_back(on);
    share.push_back(1 - off / on);
  }
  const double step = median(with);
  std::printf("%-10s %7zu %9zu %10.1f %9.2f %11.1f %13.2f\n", scene.organs[0].name.c_str(),
              model.surface_node_count(), model.network.springs.size(), step * 1e6,
              step * 1e9 / static_cast<double>(model.network.springs.size()), 100 * median(share),
              h / step);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: palpate-bench-step-cost SCENE…\n");
    return kExitBadInput;
  }
  std::printf("%-10s %7s %9s %10s %9s %11s %13s\n", "organ", "nodes", "springs", "us/step",
              "ns/spring", "volume [%]", "sim s/wall s");
  try {
    for (int i = 1; i < argc; ++i) measure(argv[i]);
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kExitBadInput;
  }
  return kExitDone;
}
