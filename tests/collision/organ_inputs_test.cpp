#include "collision/organ_inputs.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstring>

#include "collision/stage.h"
#include "modules/bus/memory_bus.h"
#include "modules/geometry/primitives.h"
#include "modules/runtime/wiring.h"
#include "tests/times.h"

using namespace palpate;
using collision::CollisionStage;

namespace {

constexpr double kBall = 0.05, kFinger = 0.01;  // radii [m]
constexpr double kBottom = -0.02;               // of the dent, beyond the ball's middle [m]

/// A finger that rests in a deep dent of a ball, which somebody tells of.
struct Pressed {
  scene::Scene scene;
  std::int64_t now_ns = 1000 * kMs;
  bus::MemoryBus bus;
  bus::Writer<SurfaceTopology> surfaces = bus.writer(bus::kSurface);
  bus::Writer<NodePositions> positions = bus.writer(bus::kNodePositions);
  bus::Writer<ProbeState> probes = bus.writer(bus::kProbeState);
  bus::Reader<Contacts> contacts = bus.reader(bus::kContacts);
  geometry::TriangleSurface ball = geometry::make_ball(kBall, 4);
  Contacts newest;
  std::uint32_t of_positions = 1;  ///< their generation

  Pressed() {
    bus.set_clock([this] { return now_ns; });
    scene.organs.resize(1);
    scene.probes.push_back({"finger", scene::SphereShape{kFinger}, 0.1, scene::TopicDevice{}});
  }
  CollisionStage stage() { return {scene, collision::load_probes(scene), bus}; }

  static std::vector<float> floats(const std::vector<Vec3>& nodes) {
    std::vector<float> all;
    for (const Vec3& x : nodes) {
      for (int axis = 0; axis < 3; ++axis) all.push_back(static_cast<float>(x[axis]));
    }
    return all;
  }
  void tell_surface(std::int64_t source_ns, std::uint32_t generation = 1) {
    SurfaceTopology surface;
    surface.header.source_time_ns = source_ns;
    surface.generation = generation;
    surface.name = "ball";
    surface.surface_node_count = static_cast<std::uint32_t>(ball.nodes.size());
    surface.rest_positions = floats(ball.nodes);
    surface.triangles = ball.triangles;
    REQUIRE(surfaces.write(surface));
  }
  /// What is above a wide finger's way down is pushed below it.
  void tell_dented(double bottom = kBottom) {
    std::vector<Vec3> nodes = ball.nodes;
    for (Vec3& x : nodes) {
      const double aside = std::hypot(x.x(), x.y());
      if (x.z() > 0 && aside < 0.03) x.z() = std::min(x.z(), bottom + 20 * aside * aside);
    }
    tell_positions(nodes);
  }
  void tell_rest() { tell_positions(ball.nodes); }
  void tell_positions(const std::vector<Vec3>& nodes) {
    NodePositions told;
    told.header.source_time_ns = now_ns;
    told.generation = of_positions;
    told.positions = floats(nodes);
    REQUIRE(positions.write(told));
  }
  void tell_finger(double above_bottom) {
    ProbeState state;
    state.header.source_time_ns = now_ns;
    state.pose.position = Vec3(0, 0, kBottom + kFinger + above_bottom);
    REQUIRE(probes.write(state));
  }
  /// A cycle, and 4 ms. @returns whether a search was told of
  bool search(CollisionStage& stage) {
    runtime::Cycle now;
    now.now_ns = now_ns;
    now.running = true;
    stage.cycle(now);
    now_ns += 4 * kMs;
    bool any = false;
    while (contacts.take(newest)) any = true;
    return any;
  }
  /// The dent's bottom holds the finger, as deep as it is, and nothing else pushes. Its edges of
  /// 3.1 mm lie above z = 20 r² by as much as 20 (1.55 mm)² = 0.048 mm.
  bool is_held_by_bottom(double above_bottom) const {
    return std::abs(newest.deepest_gap() - above_bottom) < 5e-5 &&
           std::ranges::all_of(newest.contacts,
                               [](const Contact& c) { return c.normal_P.z() > 0; });
  }
};

}  // namespace

TEST_CASE(
    "organ inputs: who begins beside a dented organ searches nothing before it knows the dent") {
  // Oracle: geometry. The finger's middle is 1 cm below the ball's, the nearest wall at rest is the
  // one below it; its own wall is the dent's bottom, into which it is pressed by 0.5 mm.
  Pressed pressed;
  auto stage = pressed.stage();
  pressed.tell_surface(pressed.now_ns - 1);
  for (int k = 0; k < 3; ++k) {
    pressed.tell_finger(-5e-4);
    CHECK_FALSE(pressed.search(stage));
  }
  for (int k = 0; k < 3; ++k) {
    pressed.tell_finger(-5e-4);
    pressed.tell_dented();
    REQUIRE(pressed.search(stage));
    CHECK(pressed.is_held_by_bottom(-5e-4));
  }
}

TEST_CASE("organ inputs: an organ told of before the first cycle is at rest until it moves") {
  // Oracle: geometry; in lockstep the first cycle comes before any positions. The finger is 2 cm
  // away from the ball at rest, and in it when it is dented.
  Pressed pressed;
  auto stage = pressed.stage();
  pressed.tell_surface(runtime::CycleGrid::kSetUp);
  pressed.tell_finger(kBall - kBottom - 5e-4);
  REQUIRE(pressed.search(stage));
  CHECK(std::abs(pressed.newest.deepest_gap() + 5e-4) < 1e-6);  // over a node
}

TEST_CASE(
    "organ inputs: a surface heard after positions that are newer leaves them where they are") {
  // Oracle: geometry, as above. A deformation that began anew is heard topic by topic: positions of
  // a surface with the same triangles, told since, came first.
  Pressed pressed;
  auto stage = pressed.stage();
  pressed.tell_surface(runtime::CycleGrid::kSetUp);
  const std::int64_t told_ns = pressed.now_ns++;
  pressed.tell_dented();
  pressed.tell_finger(-5e-4);
  REQUIRE(pressed.search(stage));
  pressed.tell_surface(told_ns);
  pressed.tell_finger(-5e-4);
  REQUIRE(pressed.search(stage));
  CHECK(pressed.is_held_by_bottom(-5e-4));
  // One of another generation that is told now begins anew: at rest the finger is deep inside.
  pressed.tell_surface(pressed.now_ns, 2);
  pressed.tell_finger(-5e-4);
  REQUIRE(pressed.search(stage));
  CHECK(pressed.newest.deepest_gap() < -0.02);
}

TEST_CASE("organ inputs: an organ that follows and changes inside alone stays in its dent") {
  // Oracle: geometry, as above. The same surface is told as of the next generation, and positions
  // of the one before and then of it; an organ that does not follow begins anew so, at rest.
  for (const bool follows : {true, false}) {
    Pressed pressed;
    pressed.scene.organs[0].solid.refine.follow = follows;
    auto stage = pressed.stage();
    pressed.tell_surface(runtime::CycleGrid::kSetUp);
    pressed.tell_dented();
    pressed.tell_finger(-5e-4);
    REQUIRE(pressed.search(stage));
    pressed.tell_surface(pressed.now_ns, 2);
    for (int k = 0; k < 3; ++k) {
      pressed.tell_finger(-5e-4);
      if (follows) pressed.tell_dented();
      REQUIRE(pressed.search(stage));
      CHECK(pressed.is_held_by_bottom(-5e-4) == follows);
      pressed.of_positions = k < 1 ? 1 : 2;
    }
  }
}

TEST_CASE("organ inputs: an organ of a process that goes on where another was stays in its dent") {
  // Oracle: geometry, as above. Its surface is told anew, of the same generation, and a while later
  // where its nodes are: in the dent, or, of a process that remembers nothing, at rest.
  for (const bool remembers : {true, false}) {
    Pressed pressed;
    auto stage = pressed.stage();
    pressed.tell_surface(runtime::CycleGrid::kSetUp);
    pressed.tell_dented();
    pressed.tell_finger(-5e-4);
    REQUIRE(pressed.search(stage));
    pressed.tell_surface(pressed.now_ns);
    for (int k = 0; k < 3; ++k) {
      pressed.tell_finger(-5e-4);
      REQUIRE(pressed.search(stage));
      CHECK(pressed.is_held_by_bottom(-5e-4));
    }
    remembers ? pressed.tell_dented() : pressed.tell_rest();
    pressed.tell_finger(-5e-4);
    REQUIRE(pressed.search(stage));
    CHECK(pressed.is_held_by_bottom(-5e-4) == remembers);
    CHECK((pressed.newest.deepest_gap() < -0.02) != remembers);
  }
}

TEST_CASE("organ inputs: a collision that was stopped says nothing before it hears where all are") {
  // Oracle: geometry. Meanwhile the finger has gone deeper, and the dent with it; on the dent of
  // before the finger is 1 cm deep. What was said as the stop began comes first.
  Pressed pressed;
  auto stage = pressed.stage();
  pressed.tell_surface(runtime::CycleGrid::kSetUp);
  pressed.tell_dented();
  pressed.tell_finger(-5e-4);
  REQUIRE(pressed.search(stage));
  pressed.tell_dented();
  pressed.tell_finger(-5e-4);
  pressed.now_ns += 1000 * kMs;
  CHECK_FALSE(pressed.search(stage));  // no word: it would be that nothing is touched
  pressed.tell_finger(-5e-4 - 0.01);
  CHECK_FALSE(pressed.search(stage));
  pressed.tell_dented(kBottom - 0.01);
  pressed.tell_finger(-5e-4 - 0.01);
  REQUIRE(pressed.search(stage));
  CHECK(std::abs(pressed.newest.deepest_gap() + 5e-4) < 5e-5);
}

TEST_CASE("organ inputs: a state whose surface names nodes that are not there is refused") {
  // Oracle: the rules of a surface on the wire; the one number that is the count of its nodes.
  Pressed pressed;
  const auto inputs = [&] {
    return collision::OrganInputs(pressed.bus, collision::load_probes(pressed.scene),
                                  pressed.scene.organs);
  };
  auto told = inputs();
  pressed.tell_surface(runtime::CycleGrid::kSetUp);
  told.take();
  StateArchive written;
  told.exchange(written);
  std::vector<std::uint8_t> bytes = written.bytes();
  const auto read = [&] {
    StateArchive archive{std::span<const std::uint8_t>(bytes)};
    inputs().exchange(archive);
  };
  CHECK_NOTHROW(read());
  const std::uint64_t count = pressed.ball.nodes.size();
  std::array<std::uint8_t, sizeof count> searched;
  std::memcpy(searched.data(), &count, sizeof count);
  const auto found = std::ranges::search(bytes, searched);
  REQUIRE(found);
  for (const std::uint64_t other : {count + 1, count / 2, count + (std::uint64_t{1} << 32)}) {
    std::memcpy(&*found.begin(), &other, sizeof other);
    CHECK_THROWS_WITH(read(), "its state holds surfaces that cannot be");
  }
}
