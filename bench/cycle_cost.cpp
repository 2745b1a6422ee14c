// What a haptic tick, a search for contacts and an advance of the organs cost within a whole
// session, one thread, without transport: for comparing builds.
//
// The session is run tick by tick. A tick is haptics alone, haptics and search, or all three: the
// search is sought twice a period of deformation so that each part is seen without the next. Times
// are first quartiles: other programs on the machine only ever add. What the slowest periods take
// is processor time of the one thread: a mesh that changes shows there.
#include <array>
#include <chrono>
#include <cstdio>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/runtime/program.h"
#include "modules/scene/scene_reader.h"
#include "palpate/session/in_process.h"
#include "studies/report/measures.h"

namespace {

using namespace palpate;

int run(const std::string& file, double seconds) {
  auto scene = scene::load_scene(file);
  scene.rates.collision = 2 * scene.rates.deformation;
  scene.rates.haptics = 4 * scene.rates.deformation;
  auto session = session::load_session(scene);
  std::array<std::vector<double>, 3> costs;  // of ticks with one, two and all three parts [s]
  std::vector<double> busy;                  // of the last [s]
  for (long tick = 0; session.time() < seconds; ++tick) {
    const auto begin = std::chrono::steady_clock::now();
    const double busy_before = report::processor_time();
    session.tick();
    const std::chrono::duration<double> cost = std::chrono::steady_clock::now() - begin;
    if (tick % 4 == 0) busy.push_back(report::processor_time() - busy_before);
    costs[tick % 4 == 0 ? 2 : tick % 2 == 0 ? 1 : 0].push_back(cost.count());
  }
  const double haptics = report::quantile(costs[0], 0.25),
               with_search = report::quantile(costs[1], 0.25),
               all = report::quantile(costs[2], 0.25);
  std::printf("%s\n%s, %g s\n", report::machine_name().c_str(), file.c_str(), seconds);
  std::printf("  haptic tick         %10.2f us\n", 1e6 * haptics);
  std::printf("  contact search      %10.2f us\n", 1e6 * (with_search - haptics));
  std::printf("  deformation period  %10.2f us\n", 1e6 * (all - with_search));
  std::printf("  such ticks, processor time: half of them %.2f ms, 99.9 %% %.2f ms, all %.2f ms\n",
              1e3 * report::quantile(busy, 0.5), 1e3 * report::quantile(busy, 0.999),
              1e3 * report::quantile(busy, 1));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  runtime::Program program("What each part of a session's cycle costs.", "palpate-bench-cycle");
  auto scene = (data_folder() / "scenes/stomach_probe.yaml").string();
  double seconds = 20;
  program.add("SCENE", scene, "Scene file (YAML)").shows_default();
  program.add("--seconds", seconds, "Of the scene, from its start")
      .range(0.1, 600.0)
      .shows_default();
  return program.run(argc, argv, [&] { return run(scene, seconds); });
}
