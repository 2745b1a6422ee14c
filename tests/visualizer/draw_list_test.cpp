#include "visualizer/draw_list.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"
#include "tests/visualizer/fake_session.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::positions_of;
using visualizer::testing::topology_of;
using visualizer::testing::two_probe_scene;

namespace {

SceneView pressed_ball() {
  SceneView view(two_probe_scene());
  const auto topology = topology_of(geometry::make_ball(0.05, 2));
  view.receive(topology);
  auto positions = positions_of(topology, 1);
  positions.positions[0] += 0.02f;
  view.receive(positions, 1);
  ProbeState probe;
  probe.pose.position = Vec3(0, 0, 0.055);
  view.receive(probe);
  Contacts contacts;
  contacts.contacts.resize(3);
  contacts.contacts[0].gap = -1e-3;
  contacts.contacts[1].gap = 5e-3;  // near, but apart
  contacts.contacts[2].gap = 0;
  view.receive(contacts);
  HapticForce force;
  force.force = Vec3(0, 0, 1.5);
  view.receive(force);
  view.refresh();
  return view;
}

}  // namespace

TEST_CASE("draw list: a node in a face is drawn on its plane, one before it is not",
          "[visualizer]") {
  // Oracle: by hand; the ball's nodes, a plane at z = 0.045 that tissue is below.
  SceneView view = pressed_ball();
  const std::size_t before = make_draw_list(view, {}).points.size();
  Contacts contacts;
  contacts.faces.resize(2);
  contacts.faces[0].point_P = Vec3(0, 0, 0.045);
  contacts.faces[1].organ = 9;
  const OrganView& organ = view.organs()[0];
  std::size_t beyond = 0;
  for (std::uint32_t i = 0; i < organ.node_count(); ++i) {
    contacts.face_nodes.push_back(i);
    beyond += organ.node(i).z() >= 0.045;
  }
  contacts.faces[0].node_count = static_cast<std::uint32_t>(organ.node_count());
  contacts.faces[1].node_count = 1;
  contacts.face_nodes.push_back(3);
  view.receive(contacts);
  view.refresh();
  const DrawList list = make_draw_list(view, {});
  CHECK(beyond > 3);
  CHECK(list.points.size() == before - 2 + beyond);
  const Vec3 shown = list.points.back().position - view.probes()[0].pose.position;
  CHECK(shown.z() == Approx(0.045).margin(1e-12));
}

TEST_CASE("draw list: nothing is drawn of what has not been heard of", "[visualizer]") {
  // Oracle: an empty session.
  SceneView view(two_probe_scene());
  view.refresh();
  const DrawList list = make_draw_list(view, {});
  CHECK(list.surfaces.empty());
  CHECK(list.bodies.empty());
  CHECK(list.points.empty());
  CHECK(list.arrows.empty());
}

TEST_CASE("draw list: one surface, the probes seen, the contacts that touch, one arrow",
          "[visualizer]") {
  // Oracle: counts of what was put in.
  const SceneView view = pressed_ball();
  const DrawList list = make_draw_list(view, {});
  REQUIRE(list.surfaces.size() == 1);
  CHECK(list.surfaces[0].triangles.size() == 320);
  CHECK(list.surfaces[0].colors.size() == 3 * 163);
  CHECK(list.surfaces[0].positions.size() == 3 * 163);
  CHECK(list.surfaces[0].normals.size() == 3 * 163);
  CHECK(list.surfaces[0].opacity == 1);
  CHECK(list.bodies.size() == 1);
  CHECK(list.points.size() == 2);
  CHECK(list.lines.size() == 3);  // two normals, and the line to the surface
  REQUIRE(list.arrows.size() == 1);
  CHECK(list.arrows[0].label == "1.50 N");
  CHECK(list.springs.empty());
}

TEST_CASE("draw list: a force says what of it is the mesh's", "[visualizer]") {
  // Oracle: the numbers put in.
  SceneView view = pressed_ball();
  ContactModel law;
  law.force_error = 0.12;
  REQUIRE(view.receive(law));
  CHECK(make_draw_list(view, {}).arrows.at(0).label == "1.50 N (mesh +12 %)");
  law.force_error = 1;
  REQUIRE(view.receive(law));
  CHECK(make_draw_list(view, {}).arrows.at(0).label == "1.50 N (mesh: twice too large)");
}

TEST_CASE("draw list: a contact is drawn where its probe is drawn", "[visualizer]") {
  // Oracle: Pose's own transformation, for a probe that has moved on since its contacts were found.
  SceneView view = pressed_ball();
  ProbeState moved;
  moved.pose = {Vec3(0.1, -0.2, 0.3), Quat(Eigen::AngleAxisd(0.7, Vec3::UnitX()))};
  view.receive(moved);
  Contacts contacts;
  contacts.contacts.resize(1);
  contacts.contacts[0].gap = -1e-3;
  contacts.contacts[0].point_P = Vec3(0.001, 0.002, -0.005);
  contacts.contacts[0].normal_P = Vec3::UnitZ();
  view.receive(contacts);
  const DrawList list = make_draw_list(view, {});
  REQUIRE(list.points.size() == 1);
  CHECK((list.points[0].position - moved.pose.to_world(contacts.contacts[0].point_P)).norm() == 0);
  REQUIRE(list.lines.size() == 2);
  const Vec3 along = (list.lines[0].to - list.lines[0].from).normalized();
  CHECK((along - moved.pose.rotation * Vec3::UnitZ()).norm() < 1e-12);
}

TEST_CASE("draw list: each spring family follows its switch", "[visualizer]") {
  // Oracle: counts: 480 edges, no bending springs in the made-up organ, 162 inner springs, and one
  // virtual node, shown with the inner springs only.
  const SceneView view = pressed_ball();
  const std::size_t marks = make_draw_list(view, {}).points.size();
  ViewOptions options;
  options.springs = {true, false, false};
  DrawList list = make_draw_list(view, options);
  REQUIRE(list.springs.size() == 1);
  CHECK(list.springs[0].family == SpringFamily::kStructural);
  CHECK(list.springs[0].ends.size() == 480);
  CHECK(list.surfaces[0].opacity == 1);
  CHECK(list.points.size() == marks);
  options.springs = {true, true, true};
  list = make_draw_list(view, options);
  CHECK(list.springs.size() == 3);
  CHECK(list.springs[2].ends.size() == 162);
  CHECK(list.surfaces[0].opacity < 1);  // or nobody would see them
  CHECK(list.points.size() == marks + 1);
}

TEST_CASE("draw list: the colour follows the quantity chosen", "[visualizer]") {
  // Oracle: the colour map at the node's own value. Node 0 was moved by 2 cm, others rest.
  const SceneView view = pressed_ball();
  ViewOptions options;
  options.coloring = Coloring::kDisplacement;
  const auto by_displacement = make_draw_list(view, options).surfaces[0].colors;
  const Rgb rest = map_color(0);
  const std::size_t last = by_displacement.size() - 6;  // a surface node far from node 0
  CHECK(Rgb{by_displacement[last], by_displacement[last + 1], by_displacement[last + 2]} == rest);
  CHECK(Rgb{by_displacement[0], by_displacement[1], by_displacement[2]} != rest);
  options.coloring = Coloring::kStrain;
  CHECK(make_draw_list(view, options).surfaces[0].colors != by_displacement);
}

TEST_CASE("draw list: the force arrow starts at the probe and has the length the label says",
          "[visualizer][analytic]") {
  // Oracle: force times force_scale; and the largest force allowed (3.3 N) fills about the radius.
  const SceneView view = pressed_ball();
  const ArrowItem arrow = make_draw_list(view, {}).arrows[0];
  CHECK(arrow.tail.isApprox(Vec3(0, 0, 0.055)));
  CHECK((arrow.tip - arrow.tail).isApprox(Vec3(0, 0, 1.5 * force_scale(view))));
  CHECK(3.3 * force_scale(view) > 0.7 * view.radius());
  CHECK(3.3 * force_scale(view) < 2.1 * view.radius());
}

TEST_CASE("draw list: no arrow without force", "[visualizer]") {
  // Oracle: the stated least force.
  SceneView view = pressed_ball();
  HapticForce none;
  none.force = Vec3(0, 0, 1e-4);
  view.receive(none);
  CHECK(make_draw_list(view, {}).arrows.empty());
}

TEST_CASE("draw list: a plane becomes a see-through patch wider than the organs", "[visualizer]") {
  // Oracle: the stated rule.
  auto scene = two_probe_scene();
  scene.probes[0].shape = scene::PlaneShape{};
  SceneView view(scene);
  view.receive(topology_of(geometry::make_ball(0.05, 2)));
  view.receive(ProbeState{});
  view.refresh();
  const BodyItem body = make_draw_list(view, {}).bodies[0];
  CHECK(body.scale > 2 * view.radius());
  CHECK(body.opacity < 1);
}

TEST_CASE("arrow solid: closed, outward, from tail to tip", "[visualizer][analytic]") {
  // Oracle: divergence theorem: the three-axis volumes of a closed surface agree, and are positive
  // if oriented outward; the extent along the axis is the arrow's.
  geometry::TriangleSurface solid;
  append_arrow({Vec3(0.1, 0, 0), Vec3(0.1, 0.03, 0.04), 0.001, {}, ""}, solid);
  const auto volumes = geometry::three_axis_volumes(solid.nodes, solid.triangles);
  CHECK(volumes[0] > 0);
  CHECK(volumes[1] == Approx(volumes[0]));
  CHECK(volumes[2] == Approx(volumes[0]));
  double least = 1, largest = -1;
  for (const Vec3& p : solid.nodes) {
    const double along = (p - Vec3(0.1, 0, 0)).dot(Vec3(0, 0.6, 0.8));
    least = std::min(least, along);
    largest = std::max(largest, along);
  }
  CHECK(least == Approx(0).margin(1e-12));
  CHECK(largest == Approx(0.05));
  geometry::TriangleSurface nothing;
  append_arrow({Vec3::Zero(), Vec3::Zero(), 0.001, {}, ""}, nothing);
  CHECK(nothing.nodes.empty());
}

TEST_CASE(
    "draw list: a probe above an organ has a line to it and a shadow that darkens as it nears",
    "[visualizer]") {
  // Oracle: the ball: the foot lies below the probe; a probe inside has neither.
  SceneView view(two_probe_scene());
  view.receive(topology_of(geometry::make_ball(0.05, 3)));
  view.refresh();
  double before = 0;
  for (const double height : {0.11, 0.09, 0.06}) {
    ProbeState probe;
    probe.pose.position = Vec3(0, 0, height);
    view.receive(probe);
    const DrawList list = make_draw_list(view, {});
    REQUIRE(list.shadows.size() == 1);
    REQUIRE(list.lines.size() == 1);
    CHECK((list.lines[0].to - Vec3(0, 0, 0.05)).norm() < 1e-3);
    CHECK(list.shadows[0].opacity > before);
    before = list.shadows[0].opacity;
  }
  ProbeState probe;
  probe.pose.position = Vec3(0, 0, 0.03);
  view.receive(probe);
  CHECK(make_draw_list(view, {}).shadows.empty());
}

TEST_CASE("draw list: a touched place is brighter, by the weights of its nodes", "[visualizer]") {
  // Oracle: the triangle and the weights of the contact.
  SceneView view = pressed_ball();
  const auto plain = make_draw_list(view, {}).surfaces[0].colors;
  Contacts contacts;
  contacts.contacts.resize(1);
  contacts.contacts[0].triangle = 7;
  contacts.contacts[0].barycentric = Vec3(1, 0, 0);
  contacts.contacts[0].gap = -1e-3;
  view.receive(contacts);
  const auto touched = make_draw_list(view, {}).surfaces[0].colors;
  const auto& nodes = view.organs()[0].surface.triangles[7];
  CHECK(touched[3 * nodes[0] + 2] > plain[3 * nodes[0] + 2]);
  CHECK(touched[3 * nodes[1] + 2] == plain[3 * nodes[1] + 2]);
}
