#include "studies/fuzz/random_probe.h"

#include <catch2/catch.hpp>
#include <set>

namespace palpate::fuzz {
namespace {

TEST_CASE("random probe: one to three, of every shape, some jump, some are held by a hand") {
  // Oracle: counting over 500 scenes.
  std::set<std::size_t> shapes;
  int jumps = 0, held = 0;
  for (std::uint64_t k = 0; k < 500; ++k) {
    const RandomScene made = random_scene(4, k);
    CHECK((!made.scene.probes.empty() && made.scene.probes.size() <= 3));
    CHECK(made.probe_shapes.size() == made.scene.probes.size());
    for (const auto& probe : made.scene.probes) {
      shapes.insert(probe.shape.index());
      const auto* way = std::get_if<scene::ScriptedDevice>(&probe.device);
      held += std::holds_alternative<scene::EmulatedDevice>(probe.device);
      if (way == nullptr) continue;
      for (const auto& move : way->moves) {
        jumps += move.to.has_value() && move.duration == 1e-3;
      }
    }
  }
  CHECK(shapes.size() == std::variant_size_v<scene::ProbeShape>);
  CHECK(jumps > 0);
  CHECK(held > 20);
}

}  // namespace
}  // namespace palpate::fuzz
