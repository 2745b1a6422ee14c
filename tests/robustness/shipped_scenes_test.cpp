// No guard acts where nothing is wrong.
#include <catch2/catch.hpp>
#include <cstdio>

#include "modules/scene/scene_reader.h"
#include "palpate/session/in_process.h"

namespace palpate {
namespace {

TEST_CASE("shipped scenes: no organ is put back and no step shortened") {
  // Oracle: each of these guards shortens steps for a second, so their number stays as it was. The
  // first 8 s hold a press of each scene, the first 3.5 s that of the refined organ.
  for (const char* name :
       {"ball_squeeze", "liver_probe", "stomach_insufflated", "stomach_probe", "own_mesh",
        "liver_solid", "stomach_probe_refined", "liver_on_stomach", "stomach_folded"}) {
    INFO(name);
    const auto scene =
        scene::load_scene(std::string(PALPATE_SOURCE_DIR "/scenes/") + name + ".yaml");
    auto pipeline = session::load_session(scene);
    const double period = 1 / scene.rates.deformation;
    const bool large = pipeline.node_positions(0).positions.size() > 15000;
    std::vector<int> usual;
    for (std::size_t organ = 0; organ < scene.organs.size(); ++organ) {
      usual.push_back(pipeline.world().substeps(organ, period));
    }
    double force = 0;
    while (pipeline.time() < (large ? 3.5 : 8.0)) {
      pipeline.tick();
      force = std::max(force, pipeline.contact_model(0).force().norm());
      for (std::size_t organ = 0; organ < usual.size(); ++organ) {
        REQUIRE(pipeline.world().substeps(organ, period) == usual[organ]);
      }
    }
    CHECK(force > 0.01);
  }
}

}  // namespace
}  // namespace palpate
