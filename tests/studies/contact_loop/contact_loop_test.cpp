#include "studies/contact_loop/contact_loop.h"

#include <catch2/catch.hpp>
#include <tuple>
#include <utility>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/geometry/primitives.h"
#include "modules/scene/scene_reader.h"

namespace palpate::contact_loop {

TEST_CASE("contact loop: no ball at any speed is inside the stomach without a contact") {
  // Oracle: winding number over all triangles of the surface each search was made on. Before, most
  // searches inside were without contact at these radii and speeds.
  const auto scene = scene::load_scene(data_file("scenes/stomach_probe.yaml"));
  const session::Assets assets = session::load_assets(scene);
  long inside = 0;
  for (const double rate : {50.0, 100.0, 250.0}) {
    for (const double radius : {5e-4, 2e-3, 8e-3}) {
      for (const double speed : {0.1, 0.63, 2.5}) {
        const LoopResult result = run_loop(scene, assets, {0.022, 0, -0.004},
                                           {make_tool("ball", radius), speed, rate, 250});
        INFO(radius << " m at " << speed << " m/s, " << rate << " Hz");
        CHECK(result.lost == 0);
        CHECK(result.crossings == 0);
        CHECK(result.swallowed == 0);
        CHECK(result.troubles.truncated == 0);
        CHECK(result.troubles.lost == 0);
        inside += result.inside;
      }
    }
  }
  CHECK(inside > 100);  // else nothing was tried
}

TEST_CASE("contact loop: no ball goes through the wall of the solid liver, whatever the rates") {
  // Oracle: winding number, after every advance. Each of these went through: found again while
  // tissue swung, gently pushed out while it moved on, off in a hurry between two searches, and
  // searched for so seldom that what was found was stale before the next.
  const auto scene = scene::load_scene(data_file("scenes/liver_solid.yaml"));
  const session::Assets assets = session::load_assets(scene);
  struct Case {
    Vec3 place;
    double radius, speed, deformation_hz, collision_hz;
  };
  const Vec3 middle(-0.020, 0, 0.013), rim(-0.082, 0, -0.063), lobe(-0.078, 0, -0.053);
  for (const Case& c : {Case{middle, 4e-3, 2.5, 50, 250}, Case{rim, 8e-3, 2.5, 50, 250},
                        Case{rim, 8e-3, 1.26, 100, 250}, Case{rim, 8e-3, 2.5, 250, 250},
                        Case{lobe, 1e-3, 2.5, 1000, 50}, Case{lobe, 5e-4, 1.26, 1000, 50},
                        Case{middle, 2e-3, 2.5, 10, 250}, Case{middle, 1e-3, 2.5, 1000, 10}}) {
    const LoopCase loop{make_tool("ball", c.radius), c.speed, c.deformation_hz, c.collision_hz};
    const LoopResult result = run_loop(scene, assets, c.place, loop);
    INFO(c.radius << " m at " << c.speed << " m/s, " << c.deformation_hz << " and "
                  << c.collision_hz << " Hz");
    CHECK(result.crossings == 0);
    CHECK(result.presses > 1);
  }
}

TEST_CASE("contact loop: no step leaves tissue in a ball that came over it and says nothing") {
  // Oracle: every triangle's nearest place to the ball's centre, after every advance. Where only
  // the way of its centre was watched, 35 of 142 advances left tissue up to 6 mm deep.
  const auto scene = scene::load_scene(data_file("scenes/stomach_probe_refined.yaml"));
  const LoopResult result = run_loop(scene, session::load_assets(scene), {0.022, 0, -0.004},
                                     {make_tool("ball", 8e-3), 2.5, 100, 250});
  CHECK(result.advances > 100);
  CHECK(result.swallowed == 0);
}

TEST_CASE("contact loop: a mesh that changes under a small tip in a hurry loses it no contact") {
  // Oracle: winding number over all triangles, of the surface of each search and each advance. Each
  // of these lost contact or was crossed: searched with boxes of an earlier mesh, walled in where
  // nodes went, crossed by its side, walled in between places along it, held to be inside for what
  // an earlier search saw, over a fold turned inside out, by a fold that a new mesh brought near.
  const auto scene = scene::load_scene(data_file("scenes/liver_touch.yaml"));
  const session::Assets assets = session::load_assets(scene);
  const Vec3 usual(-0.020, 0, 0.013), edge(0.020781514, 0, 0.021756684),
      lobe(-0.0788558858275641, 0, -0.0525599454110841),
      rim(0.0207815136525307, 0, 0.0217566838504579);
  for (const auto& [name, place, speed, rate] : {std::tuple("ball", usual, 2.5, 100.0),
                                                 {"needle", usual, 0.63, 250.0},
                                                 {"rod", usual, 2.5, 100.0},
                                                 {"rod", edge, 2.5, 250.0},
                                                 {"needle", rim, 0.63, 250.0},
                                                 {"rod", lobe, 2.5, 100.0},
                                                 {"wire", usual, 0.63, 100.0}}) {
    long inside = 0;
    for (const double searches : {250.0, 500.0}) {
      const LoopCase loop{make_tool(name, 1e-3), speed, rate, searches};
      const LoopResult result = run_loop(scene, assets, place, loop);
      INFO(name << " at " << speed << " m/s, " << rate << " and " << searches << " Hz");
      CHECK(result.lost == 0);
      CHECK(result.troubles.lost == 0);
      CHECK(result.crossings == 0);
      inside += result.inside;
    }
    CHECK(inside > 100);  // else nothing was tried
  }
}

TEST_CASE("contact loop: no other tool is inside the stomach without a contact either") {
  // Oracle: winding numbers of the core's points and of all corners. Walls come into a mesh at
  // 2.5 m/s (docs/contact.md).
  const auto scene = scene::load_scene(data_file("scenes/stomach_probe.yaml"));
  const session::Assets assets = session::load_assets(scene);
  for (const char* name : {"needle", "rod", "box", "blade", "mesh", "cone", "grasper"}) {
    const Tool tool = make_tool(name, 0);
    long inside = 0;
    // Slow at 250 Hz is left to the ball above: it takes as long as the other three together.
    for (const auto& [rate, speed] : {std::pair{50.0, 0.1}, {50.0, 2.5}, {250.0, 2.5}}) {
      const LoopResult result =
          run_loop(scene, assets, {0.022, 0, -0.004}, {tool, speed, rate, 250});
      INFO(name << " at " << speed << " m/s, " << rate << " Hz");
      CHECK(result.lost == 0);
      if (tool.name != "mesh" || speed < 1) CHECK(result.crossings == 0);
      CHECK(result.troubles.lost == 0);
      CHECK(result.troubles.truncated == 0);
      inside += result.inside;
    }
    CHECK(inside > 100);  // else nothing was tried
  }
}

TEST_CASE("contact loop: contact is kept when one of five messages is lost") {
  // Oracle: winding number, on the surface that each search had.
  const auto scene = scene::load_scene(data_file("scenes/stomach_probe.yaml"));
  const session::Assets assets = session::load_assets(scene);
  for (const char* name : {"ball", "needle", "mesh", "cone"}) {
    long inside = 0;
    for (const double rate : {50.0, 250.0}) {
      for (const double speed : {0.1, 1.0}) {
        const LoopCase loop{make_tool(name, 1e-3), speed, rate, 250, 0.2};
        const LoopResult result = run_loop(scene, assets, {0.022, 0, -0.004}, loop);
        INFO(name << " at " << speed << " m/s, " << rate << " Hz");
        CHECK(result.lost == 0);
        inside += result.inside;
      }
    }
    CHECK(inside > 30);  // else nothing was tried
  }
}

TEST_CASE("contact loop: a thin rod keeps contact though messages are lost") {
  // Oracle: winding number, on the surface that each search had. Each of these lost contact: on its
  // way out of tissue that nobody told of meanwhile, the rod's middle was inside and its ends not.
  for (const auto& [name, place, speed, rate, loss] :
       {std::tuple("stomach_probe", Vec3(0.022, 0, -0.004), 1.26, 50.0, 0.6),
        {"stomach_probe", Vec3(0.022, 0, -0.004), 0.63, 50.0, 0.3},
        {"liver_solid", Vec3(-0.020, 0, 0.013), 2.5, 250.0, 0.6}}) {
    const auto scene = scene::load_scene(data_file("scenes") / (std::string(name) + ".yaml"));
    const session::Assets assets = session::load_assets(scene);
    const LoopCase loop{make_tool("wire", 0), speed, rate, 250, loss};
    const LoopResult result = run_loop(scene, assets, place, loop);
    INFO(name << " at " << speed << " m/s, " << rate << " Hz");
    CHECK(result.lost == 0);
    CHECK(result.inside > 20);  // else nothing was tried
  }
}

TEST_CASE("contact loop: a tool reaches as far before its origin as its points say") {
  // Oracle: brute force over the surface of each shape.
  for (const char* name :
       {"ball", "needle", "rod", "wire", "box", "blade", "mesh", "cone", "grasper"}) {
    const Tool tool = make_tool(name, 3e-3);
    const auto surface = geometry::surface_of(scene::form_of(tool.shape, tool.mesh), 1);
    double reach = 0;
    for (const Vec3& x : surface.nodes) reach = std::max(reach, (tool.rotation * x).y());
    CHECK(reach == Approx(tool.reach).epsilon(0.02).margin(1e-12));
    for (const Vec3& x : tool.inside) CHECK((tool.rotation * x).y() <= reach + 1e-12);
  }
  CHECK_THROWS_AS(make_tool("hammer", 1), InputError);
}

}  // namespace palpate::contact_loop
