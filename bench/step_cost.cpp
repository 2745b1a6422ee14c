// What one deformation step costs: the plain code and the spring kernel with each instruction set,
// from 550 to 200,000 nodes.
//
// All variants of a size take turns of some steps, so that a machine whose speed drifts slows all.
// Times are first quartiles over the rounds: other programs on the machine only ever add. The
// streaming bound is the time in which the same core merely reads all arrays of a step and writes
// its results.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <numeric>

#include "bench/fine_surface.h"
#include "deformation/springs/kernel/spring_kernel.h"
#include "deformation/steppers/backward_euler.h"
#include "deformation/steppers/symplectic_euler.h"
#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/runtime/program.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"
#include "studies/report/measures.h"

namespace {

using namespace palpate;
using deformation::InstructionSet;

constexpr double kTurn = 1e-3;  // [s], at least
constexpr int kLeastSteps = 8;  // of a turn, so that its arrays are where they are in a session
constexpr double kBackwardStep = 4e-3;  // [s]
constexpr double kSeconds = 5.0;        // per size, about

deformation::OrganState swinging(const deformation::OrganModel& model) {
  auto state = deformation::rest_state(model);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3& p = state.positions[i];
    if (model.inverse_masses[i] > 0) state.velocities[i] = Vec3(p.z(), 0, p.x());
  }
  return state;
}

/// One way to do a step, measured again and again.
struct Variant {
  std::string name;
  std::function<void()> step;
  std::vector<double> seconds;  ///< per step, by round
};

double seconds_per_step(const Variant& variant, int steps) {
  variant.step();
  const auto start = std::chrono::steady_clock::now();
  for (int s = 0; s < steps; ++s) variant.step();
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return elapsed.count() / steps;
}

double first_quartile(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 4];
}

double ratio(const Variant& over, const Variant& under) {
  return first_quartile(over.seconds) / first_quartile(under.seconds);
}

Variant plain_variant(const deformation::OrganModel& model, double h) {
  auto state = std::make_shared<deformation::OrganState>(swinging(model));
  auto buffers = std::make_shared<deformation::StepBuffers>();
  return {"plain",
          [&model, h, state, buffers] {
            deformation::symplectic_euler_step(model, h, {}, *state, *buffers);
          },
          {}};
}

/// One thread; knows how long it was in loops that more could share.
class TimedRunner : public ChunkRunner {
 public:
  void run(std::size_t count, ChunkBody body) override {
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t chunk = 0; chunk < count; ++chunk) body(chunk);
    shared += std::chrono::steady_clock::now() - start;
  }
  std::chrono::duration<double> shared{0};
};

/// The part of a step of backward Euler that threads can share: what they gain where cores are
/// free, whether or not they are now.
double shared_part_of_backward_euler(const deformation::OrganModel& model) {
  constexpr int kSteps = 50;
  TimedRunner runner;
  auto state = swinging(model);
  deformation::BackwardEuler stepper(model, deformation::KeptVolume{},
                                     deformation::BackwardEuler::kIterations, &runner);
  stepper.step(kBackwardStep, {}, state);
  runner.shared = std::chrono::duration<double>(0);
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < kSteps; ++k) stepper.step(kBackwardStep, {}, state);
  return runner.shared / (std::chrono::steady_clock::now() - start);
}

Variant backward_variant(const std::string& name, const deformation::OrganModel& model,
                         ChunkRunner* runner) {
  auto state = std::make_shared<deformation::OrganState>(swinging(model));
  auto stepper = std::make_shared<deformation::BackwardEuler>(
      model, deformation::KeptVolume{}, deformation::BackwardEuler::kIterations, runner);
  return {name, [state, stepper] { stepper->step(kBackwardStep, {}, *state); }, {}};
}

Variant kernel_variant(const std::string& name, const deformation::OrganModel& model, double h,
                       bool with_volume, InstructionSet set, ChunkRunner* runner) {
  auto state = std::make_shared<deformation::OrganState>(swinging(model));
  auto free = std::make_shared<deformation::FreeStep>();
  auto kernel =
      std::make_shared<deformation::SpringKernel>(model, model.network(), with_volume, runner, set);
  return {name,
          [with_volume, h, state, free, kernel] {
            kernel->free_step(h, *state, *free);
            double impulse = 0;
            if (with_volume) {
              const double rate = (free->volume.volume - state->target_volume) / h;
              impulse = (rate + free->volume_velocity) / free->volume.denominator;
            }
            kernel->finish_step(h, impulse, *free, *state);
          },
          {}};
}

/// Numbers a step must read and write at least, 8 bytes each.
struct Traffic {
  std::size_t read = 0, written = 0;
};

Traffic traffic_of(const deformation::OrganModel& model) {
  const deformation::SpringKernelLayout layout(model, model.network(), true);
  const auto view = layout.view();
  const auto& last = view.slices[view.slice_count - 1];
  const std::size_t rows = view.slice_count * deformation::kernel::kLanes;
  const std::size_t half_springs = (last.first_slot + last.slots) * deformation::kernel::kLanes;
  const std::size_t coordinates = 3 * model.node_count();
  const auto& fans = view.cover.fans[view.first_fans[view.chunk_count] - 1];
  const std::size_t fan_nodes = (fans.first_slot + fans.slots) * deformation::kernel::kDoubleLanes;
  // neighbour and rest length (half a number each); fan node (half); inner spring (two), masses
  // (three); x and v; then x, v⁺
  return {half_springs + fan_nodes / 2 + rows * 5 + 2 * coordinates, 2 * coordinates};
}

Variant streaming_variant(const Traffic& traffic) {
  auto input = std::make_shared<std::vector<std::uint64_t>>(traffic.read, 1);
  auto output = std::make_shared<std::vector<std::uint64_t>>(traffic.written, 0);
  return {"streaming bound",
          [input, output] {
            const auto sum = std::accumulate(input->begin(), input->end(), std::uint64_t{0});
            std::fill(output->begin(), output->end(), sum);
          },
          {}};
}

void print(const Variant& variant, const Variant& plain, std::size_t springs) {
  const double seconds = first_quartile(variant.seconds);
  std::printf("  %-22s %11.2f %9.3f %9.2f\n", variant.name.c_str(), seconds * 1e6,
              seconds * 1e9 / static_cast<double>(springs), ratio(plain, variant));
}

void measure(const scene::Organ& organ, const Vec3& gravity,
             const geometry::TriangleSurface& surface) {
  const auto model = deformation::build_organ_model(organ, gravity, surface);
  const double h = 0.9 * deformation::stable_step_bound(model);
  const auto sets = deformation::available_instruction_sets();
  runtime::WorkerTeam team(2);

  std::vector<Variant> variants{plain_variant(model, h), streaming_variant(traffic_of(model))};
  for (const InstructionSet set : sets) {
    variants.push_back(kernel_variant(deformation::name_of(set), model, h, true, set, nullptr));
  }
  variants.push_back(kernel_variant("the last, no volume", model, h, false, sets.back(), nullptr));
  variants.push_back(kernel_variant("the last, two threads", model, h, true, sets.back(), &team));

  variants.push_back(backward_variant("backward Euler", model, nullptr));
  variants.push_back(backward_variant("backward, two threads", model, &team));

  const double plain_step = seconds_per_step(variants[0], 1);
  const int steps = std::max(kLeastSteps, static_cast<int>(kTurn / plain_step));
  const double round_seconds = (steps + 1) * plain_step * static_cast<double>(variants.size());
  const int rounds = std::clamp(static_cast<int>(kSeconds / round_seconds), 5, 400);
  for (int round = 0; round < rounds; ++round) {
    for (Variant& v : variants) v.seconds.push_back(seconds_per_step(v, steps));
  }

  const std::size_t springs = model.network().springs.size();
  std::printf("%zu nodes, %zu springs\n", model.surface_node_count, springs);
  std::printf("  %-22s %11s %9s %9s\n", "", "us/step", "ns/spring", "speed-up");
  for (const Variant& v : variants) print(v, variants[0], springs);
  const Variant& best = variants[1 + sets.size()];
  const Variant &no_volume = variants[2 + sets.size()], &two = variants[3 + sets.size()];
  const Variant &backward = variants[4 + sets.size()], &two_backward = variants[5 + sets.size()];
  std::printf(
      "  volume constraint %.1f %% of the step; two threads %.2f times one; "
      "%.1f times the streaming bound\n",
      100 * (1 - ratio(no_volume, best)), ratio(best, two), ratio(best, variants[1]));
  const double shared = shared_part_of_backward_euler(model);
  std::printf(
      "  backward Euler, a step of 4 ms: two threads %.2f times one; %.1f %% of it is in loops "
      "that "
      "threads share, for %.2f times at best\n",
      ratio(backward, two_backward), 100 * shared, 1 / (1 - shared / 2));
}

int run(const std::string& scene_file, const std::vector<std::size_t>& sizes) {
  const auto scene = scene::load_scene(scene_file);
  const scene::Organ& organ = scene.organs[0];
  const auto surface = scene::load_organ(organ).surface;
  std::printf("%s; organ '%s'\n", report::machine_name().c_str(), organ.name.c_str());
  for (const std::size_t nodes : sizes) {
    measure(organ, scene.gravity, bench::fine_surface(surface, nodes));
  }
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  runtime::Program program("What one deformation step costs, by mesh size and instruction set.",
                           "palpate-bench-step-cost");
  auto scene = (data_folder() / "scenes/stomach_probe_refined.yaml").string();
  std::vector<std::size_t> sizes{550, 5'000, 19'362, 200'000};
  program.add("--scene", scene, "Scene whose first organ is measured").shows_default();
  program
      .add("--nodes", sizes,
           "Mesh sizes; above 20,000 made by halving the edges of a "
           "fourth of the nodes as often as needed")
      .range(4, 1'000'000)
      .shows_default();
  return program.run(argc, argv, [&] { return run(scene, sizes); });
}
