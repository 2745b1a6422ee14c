#include "collision/stage.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "collision/contact_reduction.h"
#include "modules/bus/memory_bus.h"
#include "modules/geometry/primitives.h"
#include "modules/runtime/wiring.h"
#include "tests/times.h"

using namespace palpate;
using collision::CollisionStage;

namespace {

constexpr double kRadius = 0.05;

/// A ball that somebody publishes, and a finger over it.
struct Session {
  scene::Scene scene;
  bus::MemoryBus bus;
  bus::Writer<SurfaceTopology> surfaces = bus.writer(bus::kSurface);
  bus::Writer<ProbeState> probes = bus.writer(bus::kProbeState);
  bus::Reader<Contacts> contacts = bus.reader(bus::kContacts);
  Contacts newest;
  std::string guard;  ///< of the last search

  Session() {
    scene.organs.resize(1);
    scene.probes.push_back({"finger", scene::SphereShape{0.01}, 0.1, scene::TopicDevice{}});
  }

  CollisionStage stage() { return {scene, collision::load_probes(scene), bus}; }

  /// At rest from before the session's first cycle on. @param blocks  told of it, at most one
  void publish_ball(std::size_t blocks = 0, int halvings = 2, std::uint32_t generation = 1) {
    const auto ball = geometry::make_ball(kRadius, halvings);
    SurfaceTopology surface;
    surface.header.source_time_ns = runtime::CycleGrid::kSetUp;
    surface.generation = generation;
    surface.name = "ball";
    surface.surface_node_count = static_cast<std::uint32_t>(ball.nodes.size());
    for (const Vec3& p : ball.nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        surface.rest_positions.push_back(static_cast<float>(p[axis]));
      }
    }
    surface.triangles = ball.triangles;
    surface.triangle_blocks.assign(blocks * ball.triangles.size(), 0);
    REQUIRE(surfaces.write(surface));
  }

  void move_finger(double height, std::int64_t now_ns) {
    ProbeState state;
    state.header.source_time_ns = now_ns;
    state.pose.position = Vec3(0, 0, height);
    REQUIRE(probes.write(state));
  }

  /// Contacts of a cycle at `now_ns`.
  std::size_t search(CollisionStage& stage, std::int64_t now_ns) {
    runtime::Cycle now;
    now.now_ns = now_ns;
    now.running = true;
    guard = stage.cycle(now).guard;
    while (contacts.take(newest)) {
    }
    return newest.contacts.size();
  }
};

}  // namespace

TEST_CASE("collision stage: is not ready, and says nothing, before it knows every organ") {
  // Oracle: by hand.
  Session session;
  auto stage = session.stage();
  session.move_finger(0.05, kMs);
  CHECK_FALSE(stage.cycle({}).ready);
  CHECK_FALSE(session.contacts.take(session.newest));
  session.publish_ball();
  CHECK(stage.cycle({}).ready);
  CHECK(session.contacts.take(session.newest));
}

TEST_CASE("collision stage: of a probe that it has never heard of it says nothing") {
  // Oracle: by hand; who begins anew hears of a finger in the ball only after some cycles, and a
  // message without contacts would say that it touches nothing.
  Session session;
  auto stage = session.stage();
  session.publish_ball();
  runtime::Cycle now;
  for (now.now_ns = kMs; now.now_ns < 20 * kMs; now.now_ns += 4 * kMs) {
    CHECK(std::string(stage.cycle(now).guard).find("no news of a probe") == 0);
    CHECK_FALSE(session.contacts.take(session.newest));
  }
  session.move_finger(0.055, now.now_ns);
  CHECK(session.search(stage, now.now_ns) > 0);
  CHECK(session.newest.deepest_gap() < 0);
  const std::int64_t late = now.now_ns + ns_from_seconds(runtime::kInputStaleAfter) + 1;
  session.newest.probe = 1;
  CHECK(session.search(stage, late) == 0);  // it has fallen silent: that is said
  CHECK(session.newest.probe == 0);
}

TEST_CASE("collision stage: a finger in the ball touches it, one far away does not") {
  // Oracle: geometry, the ball's top is at 5 cm.
  Session session;
  auto stage = session.stage();
  session.publish_ball();
  session.move_finger(0.2, kMs);
  CHECK(session.search(stage, kMs) == 0);
  session.move_finger(0.055, 5 * kMs);
  CHECK(session.search(stage, 5 * kMs) > 0);
  CHECK(session.newest.probe_pose.position.z() == 0.055);
}

TEST_CASE("collision stage: of a sharp tool in a hurry all that it may come to is told") {
  // Oracle: the nodes that a box at 2.5 m/s may come to before the next search's contacts: those
  // within its way ahead, to whatever side. They are more than a list usually holds.
  Session session;
  constexpr double kHalf = 0.015, kSpeed = 2.5, kHeight = kRadius + kHalf + 1e-3;
  session.scene.probes[0].shape = scene::BoxShape{Vec3::Constant(2 * kHalf)};
  session.scene.rates.deformation = session.scene.rates.collision = 100;
  auto stage = session.stage();
  session.publish_ball(0, 6);
  ProbeState state;
  state.header.source_time_ns = kMs;
  state.pose.position = Vec3(0, 0, kHeight);
  state.twist.linear = Vec3(0, 0, -kSpeed);
  REQUIRE(session.probes.write(state));
  CHECK(session.search(stage, kMs) > collision::kUsualContacts);
  CHECK_FALSE(session.newest.truncated);
  CHECK(session.guard.empty());
  // The box's bottom, and what lies around it, each node once.
  std::vector<std::uint32_t> told = session.newest.face_nodes;
  const auto ball = geometry::make_ball(kRadius, 6);
  for (const Contact& c : session.newest.contacts) {
    for (int k = 0; k < 3; ++k) {
      if (c.barycentric[k] == 1) told.push_back(ball.triangles[c.triangle][k]);
    }
  }
  std::ranges::sort(told);
  const double way = kSpeed * 2 / 100;
  std::size_t near = 0;
  for (std::uint32_t node = 0; node < ball.nodes.size(); ++node) {
    const Vec3 from_box = ball.nodes[node] - Vec3(0, 0, kHeight);
    const Vec3 off = from_box - from_box.cwiseMax(-kHalf).cwiseMin(kHalf);
    // Some of what faces the box, well within the way ahead.
    if (ball.nodes[node].z() < 0.02 || off.norm() > way / 2) continue;
    ++near;
    if (!std::ranges::binary_search(told, node)) FAIL_CHECK("node " << node << " is not told");
  }
  CHECK(near > collision::kUsualContacts);
}

TEST_CASE(
    "collision stage: where an organ is, is told by its blocks' boxes, or seen without them") {
  // Oracle: by construction; the ball's only block is told to be elsewhere, then truly, then not.
  Session session;
  auto stage = session.stage();
  session.publish_ball(1);
  auto positions = session.bus.writer(bus::kNodePositions);
  NodePositions told;
  told.generation = 1;
  for (const Vec3& x : geometry::make_ball(kRadius, 2).nodes) {
    for (int axis = 0; axis < 3; ++axis) told.positions.push_back(static_cast<float>(x[axis]));
  }
  const float radius = 0.051F;
  std::int64_t now_ns = kMs;
  for (const auto& [boxes, is_found] :
       {std::pair(std::vector<float>{1, 1, 1, 2, 2, 2}, false),
        std::pair(std::vector<float>{-radius, -radius, -radius, radius, radius, radius}, true),
        std::pair(std::vector<float>{}, true)}) {
    told.block_boxes = boxes;
    // Twice, for a search goes from the shape before to the newest.
    for (int k = 0; k < 2; ++k, now_ns += 4 * kMs) {
      NodePositions message = told;
      REQUIRE(positions.write(message));
      session.move_finger(0.0605, now_ns);
      session.search(stage, now_ns);
    }
    CHECK(session.newest.contacts.empty() != is_found);
    CHECK(session.guard.empty());
  }
  told.block_boxes.assign(12, 0);  // of two blocks
  REQUIRE(positions.write(told));
  session.move_finger(0.0605, now_ns);
  CHECK(session.search(stage, now_ns) > 0);
  CHECK(session.guard.find("node_positions tells boxes of other blocks") == 0);
}

TEST_CASE("collision stage: a mesh that changes in every advance is searched as it is") {
  // Oracle: by construction; each time positions of the surface told before come together with the
  // next surface. Every second one has the first one's triangles again.
  Session session;
  auto stage = session.stage();
  session.publish_ball();
  auto positions = session.bus.writer(bus::kNodePositions);
  std::int64_t now_ns = kMs;
  stage.cycle({});
  session.publish_ball(0, 3, 2);
  stage.cycle({});
  for (std::uint32_t generation = 2; generation < 12; ++generation, now_ns += 4 * kMs) {
    CAPTURE(generation);
    const int halvings = generation % 2 == 0 ? 3 : 2;
    NodePositions moved;
    moved.generation = generation;
    const float aside = 1e-3F * static_cast<float>(generation);
    for (const Vec3& x : geometry::make_ball(kRadius, halvings).nodes) {
      for (int axis = 0; axis < 3; ++axis) moved.positions.push_back(static_cast<float>(x[axis]));
      moved.positions.back() += aside;
    }
    REQUIRE(positions.write(moved));
    session.publish_ball(0, 5 - halvings, generation + 1);
    session.move_finger(0.0595 + aside, now_ns);
    REQUIRE(session.search(stage, now_ns) > 0);
    CHECK(session.newest.generations == std::vector<std::uint32_t>{generation});
    CHECK(std::abs(session.newest.deepest_gap() + 5e-4) < 1e-6);  // the finger is over a node
  }
}

TEST_CASE("collision stage: a probe that fell silent touches nothing, and its status says so") {
  // Oracle: the documented limit, runtime::kInputStaleAfter.
  Session session;
  auto stage = session.stage();
  session.publish_ball();
  session.move_finger(0.055, kMs);
  REQUIRE(session.search(stage, kMs) > 0);
  const std::int64_t late = kMs + ns_from_seconds(runtime::kInputStaleAfter) + 1;
  CHECK(session.search(stage, late) == 0);
  runtime::Cycle now;
  now.now_ns = late;
  CHECK(std::string(stage.cycle(now).guard).find("no news of a probe") == 0);
}

TEST_CASE(
    "collision stage: a finger first heard of inside touches at once, and its status says so") {
  // Oracle: geometry; the finger's middle is 1 cm below the ball's top. Begun inside: at the start,
  // after silence, after a jump of 9 cm in 4 ms. Not begun: moved in, at 2.5 m/s.
  Session session;
  auto stage = session.stage();
  session.publish_ball();
  std::int64_t now_ns = kMs;
  const auto guard_at = [&](double height, std::int64_t after_ns) {
    now_ns += after_ns;
    session.move_finger(height, now_ns);
    runtime::Cycle now;
    now.now_ns = now_ns;
    now.running = true;
    const std::string guard = stage.cycle(now).guard;
    while (session.contacts.take(session.newest)) {
    }
    const auto& found = session.newest.contacts;
    const auto pushes = [](const Contact& c) { return c.gap < -0.015; };
    CHECK(std::any_of(found.begin(), found.end(), pushes) == (height < 0.045));
    return guard;
  };
  const std::string kBegun = "a probe was first heard of inside";
  CHECK(guard_at(0.04, 0).find(kBegun) == 0);
  CHECK(guard_at(0.04, 4 * kMs).empty());
  CHECK(guard_at(0.04, ns_from_seconds(runtime::kInputStaleAfter) + 1).empty());
  runtime::Cycle silent;
  silent.now_ns = now_ns += ns_from_seconds(runtime::kInputStaleAfter) + 1;
  CHECK(std::string(stage.cycle(silent).guard).find("no news") == 0);
  CHECK(guard_at(0.04, 4 * kMs).find(kBegun) == 0);
  CHECK(guard_at(0.05, 4 * kMs).empty());
  CHECK(guard_at(0.04, 4 * kMs).empty());
  CHECK(guard_at(0.13, 1000 * kMs / 25).empty());
  CHECK(guard_at(0.04, 4 * kMs).find(kBegun) == 0);
}

TEST_CASE("collision stage: a probe that is inside as the session waits is told of as it begins") {
  // Oracle: the definition. Nobody is degraded while a session waits: what a search tells then is
  // lost, unless it is told again in the first cycle that runs, once.
  Session session;
  auto stage = session.stage();
  session.publish_ball();
  const auto guard_at = [&](std::int64_t now_ns, bool running) {
    session.move_finger(0.04, now_ns);
    runtime::Cycle now;
    now.now_ns = now_ns;
    now.running = running;
    return std::string(stage.cycle(now).guard);
  };
  const std::string kBegun = "a probe was first heard of inside";
  for (int i = 1; i < 10; ++i) guard_at(4 * i * kMs, false);
  CHECK(guard_at(40 * kMs, true).find(kBegun) == 0);
  CHECK(guard_at(44 * kMs, true).empty());
}
