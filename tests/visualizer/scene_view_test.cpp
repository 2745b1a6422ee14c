#include "visualizer/scene_view.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"
#include "tests/times.h"
#include "tests/visualizer/fake_session.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::positions_of;
using visualizer::testing::topology_of;
using visualizer::testing::two_probe_scene;

namespace {

SurfaceTopology ball_topology(std::uint32_t generation = 1) {
  return topology_of(geometry::make_ball(0.05, 2), generation);
}

void scale(NodePositions& positions, float factor) {
  for (float& x : positions.positions) x *= factor;
}

}  // namespace

TEST_CASE("scene view: strain and displacement of a uniformly scaled ball",
          "[visualizer][analytic]") {
  // Oracle: analytic. Scaling a ball of radius R by s: strain s - 1, displacement R (s - 1);
  // tolerances from float positions (see shape_measures).
  SceneView view(two_probe_scene());
  const auto topology = ball_topology();
  REQUIRE(view.receive(topology));
  auto positions = positions_of(topology, 0.5);
  scale(positions, 1.2f);
  REQUIRE(view.receive(positions, kSecond));
  view.refresh();
  const OrganView& organ = view.organs()[0];
  for (std::uint32_t i = 0; i < topology.surface_node_count; ++i) {
    CHECK(organ.node_strain[i] == Approx(0.2).margin(1e-5));
    CHECK(organ.displacement[i] == Approx(0.01).margin(1e-7));
  }
  CHECK(organ.displacement[topology.surface_node_count] == Approx(0).margin(1e-7));
  // 1, 2, 5 rounding of 0.2 and of 0.01 upwards, on either side of the rounding of floats.
  CHECK((view.strain_top() == Approx(0.2) || view.strain_top() == Approx(0.5)));
  CHECK((view.displacement_top() == Approx(0.01) || view.displacement_top() == Approx(0.02)));
  CHECK(view.sim_time() == Approx(0.5));
}

TEST_CASE("scene view: positions before the surface, or of another one, change nothing",
          "[visualizer][fault]") {
  // Oracle: the stated rule.
  SceneView view(two_probe_scene());
  const auto topology = ball_topology(3);
  CHECK_FALSE(view.receive(positions_of(topology), kSecond));  // surface not known yet
  REQUIRE(view.receive(topology));
  auto other = positions_of(topology, 1);
  other.generation = 2;
  CHECK_FALSE(view.receive(other, kSecond));
  auto short_one = positions_of(topology, 1);
  short_one.positions.resize(9);
  CHECK_FALSE(view.receive(short_one, kSecond));
  CHECK(view.organs()[0].newest.positions == topology.rest_positions);
  CHECK(view.sim_time() == 0);
  view.refresh();  // and nothing in the picture breaks
  CHECK(view.receive(positions_of(topology, 1), kSecond));
}

TEST_CASE("scene view: unknown organs and probes and bad indices are refused",
          "[visualizer][fault]") {
  // Oracle: the stated rule.
  SceneView view(two_probe_scene());
  auto topology = ball_topology();
  topology.organ = 5;
  CHECK_FALSE(view.receive(topology));
  topology = ball_topology();
  topology.triangles[0][1] = topology.surface_node_count;  // the virtual node is no surface node
  CHECK_FALSE(view.receive(topology));
  topology = ball_topology();
  topology.springs[0].node_b = 100000;
  CHECK_FALSE(view.receive(topology));
  topology = ball_topology();
  topology.rest_positions.pop_back();
  CHECK_FALSE(view.receive(topology));
  NodePositions positions;
  positions.organ = 9;
  CHECK_FALSE(view.receive(positions, kSecond));
  ProbeState probe;
  probe.probe = 2;
  CHECK_FALSE(view.receive(probe));
  Contacts contacts;
  contacts.probe = 77;
  CHECK_FALSE(view.receive(contacts));
  HapticForce force;
  force.probe = 2;
  CHECK_FALSE(view.receive(force));
  ContactModel law;
  law.probe = 2;
  CHECK_FALSE(view.receive(law));
  CHECK_FALSE(view.organs()[0].known);
}

TEST_CASE("scene view: a new generation replaces the surface and sorts its springs",
          "[visualizer]") {
  // Oracle: counts of a closed surface: edges = 3/2 triangles; the stated rule: the picture stays
  // until positions of the new surface come, and those of one passed over are never shown.
  SceneView view(two_probe_scene());
  const auto coarse = ball_topology(1);
  REQUIRE(view.receive(coarse));
  REQUIRE(view.receive(positions_of(coarse, 1), kSecond));
  const auto finer = topology_of(geometry::make_ball(0.05, 3), 3);
  REQUIRE(view.receive(ball_topology(2)));
  REQUIRE(view.receive(finer));
  const OrganView& organ = view.organs()[0];
  CHECK(organ.shape_version == 1);
  CHECK(view.receive(positions_of(coarse, 1.1), kSecond));
  CHECK(view.receive(positions_of(finer, 1.2), kSecond));
  CHECK(organ.shape_version == 2);
  CHECK(organ.surface.generation == 3);
  CHECK_FALSE(view.receive(positions_of(ball_topology(2), 1.3), kSecond));
  CHECK(organ.springs[0].size() == 3 * finer.triangles.size() / 2);
  CHECK(organ.springs[1].empty());
  CHECK(organ.springs[2].size() == finer.surface_node_count);
}

TEST_CASE("scene view: histories follow the messages and start again after a reset",
          "[visualizer]") {
  // Oracle: the numbers put in.
  SceneView view(two_probe_scene());
  const auto topology = ball_topology();
  REQUIRE(view.receive(topology));
  for (int i = 0; i <= 10; ++i) {
    auto positions = positions_of(topology, 0.1 * i);
    positions.volume = positions.target_volume * (1 + 1e-4 * i);
    positions.pressure = 10 * i;
    view.receive(positions, kSecond);
    HapticForce force;
    force.header.sim_time_ns = positions.header.sim_time_ns;
    force.force = Vec3(0, 0.3 * i, 0.4 * i);
    view.receive(force);
  }
  CHECK(view.organs()[0].volume_error.newest().value == Approx(1e-3));
  CHECK(view.organs()[0].pressure.size() == 11);
  CHECK(view.probes()[0].force_magnitude.newest().value == Approx(5));
  view.receive(positions_of(topology, 0), kSecond);
  CHECK(view.organs()[0].pressure.size() == 1);
  CHECK(view.sim_time() == 0);
}

TEST_CASE("scene view: the extent holds the organs", "[visualizer][analytic]") {
  // Oracle: analytic; a ball of 5 cm about (1, 2, 3) cm, its nodes on the sphere.
  auto surface = geometry::make_ball(0.05, 3);
  for (Vec3& p : surface.nodes) p += Vec3(0.01, 0.02, 0.03);
  SceneView view(two_probe_scene());
  view.receive(topology_of(surface));
  CHECK((view.center() - Vec3(0.01, 0.02, 0.03)).norm() < 1e-4);
  CHECK(view.radius() == Approx(0.05).epsilon(1e-3));
}

TEST_CASE("scene view: ages and the real-time factor", "[visualizer]") {
  // Oracle: the numbers put in.
  SceneView view(two_probe_scene());
  CHECK(std::isinf(view.positions_age(kSecond)));
  CHECK(view.real_time_factor() == 0);
  const auto topology = ball_topology();
  view.receive(topology);
  view.receive(positions_of(topology, 1), 4 * kSecond);
  CHECK(view.positions_age(7 * kSecond) == Approx(3));
  ModuleStatus status;
  status.module = "deformation";
  status.real_time_factor = 0.4;
  view.receive(status, kSecond);
  CHECK(view.real_time_factor() == Approx(0.4));
}

TEST_CASE("scene view: colour scales grow at once and shrink reluctantly", "[visualizer]") {
  // Oracle: the stated rule.
  SceneView view(two_probe_scene());
  const auto topology = ball_topology();
  view.receive(topology);
  const auto show = [&](double time, float factor) {
    auto positions = positions_of(topology, time);
    scale(positions, factor);
    view.receive(positions, kSecond);
    view.refresh();
  };
  show(0.1, 1.4f);
  CHECK(view.strain_top() == Approx(0.5));
  show(0.2, 1.18f);  // 0.2 would do: more than a quarter
  CHECK(view.strain_top() == Approx(0.5));
  show(0.3, 1.02f);  // 0.05 would do
  CHECK(view.strain_top() == Approx(0.05));
}
