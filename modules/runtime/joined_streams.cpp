#include "modules/runtime/joined_streams.h"

#include <algorithm>
#include <array>

#include "modules/bus/topics.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/processes.h"

namespace palpate::runtime {
namespace {

constexpr std::array<std::string_view, 3> kTouch{"haptics", "collision", "deformation"};

bool is_of_touch(std::string_view job) { return std::ranges::find(kTouch, job) != kTouch.end(); }

/// Of a module in the scene's session.
int processes_of(std::string_view job, const scene::Scene& scene) {
  if (!is_of_touch(job)) return 0;
  return job == "deformation" ? static_cast<int>(scene::process_count(scene)) : 1;
}

bool is_joined(const bus::Input& input, const scene::Scene& scene) {
  const Wire* const wire = find_wire(input.topic().name);
  if (wire == nullptr || !is_of_touch(wire->writer)) return true;
  const bool said_when_running = wire->topic == bus::kContactModel.name;
  return input.matched_writers() >= processes_of(wire->writer, scene) &&
         (said_when_running || input.statistics().received > 0);
}

bool is_joined(const bus::Output& output, const scene::Scene& scene) {
  const Wire* const wire = find_wire(output.topic().name);
  if (wire == nullptr) return true;
  int readers = 0;
  for (const std::string_view reader : wire->readers) readers += processes_of(reader, scene);
  return output.matched_readers() >= readers;
}

}  // namespace

bool are_streams_joined(const bus::Bus& bus, const scene::Scene& scene, std::string_view module) {
  const auto named = module_named(module);
  if (!named || !is_of_touch(named->job)) return true;
  return std::ranges::all_of(bus.inputs(), [&](auto* of) { return is_joined(*of, scene); }) &&
         std::ranges::all_of(bus.outputs(), [&](auto* of) { return is_joined(*of, scene); });
}

}  // namespace palpate::runtime
