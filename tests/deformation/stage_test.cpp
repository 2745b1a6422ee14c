#include "deformation/stage.h"

#include <catch2/catch.hpp>

#include "deformation/usual_age.h"
#include "modules/bus/memory_bus.h"
#include "modules/geometry/surface_blocks.h"
#include "tests/deformation/organs.h"
#include "tests/modules/geometry/tetrahedra.h"

using namespace palpate;
using namespace palpate::deformation;

namespace {

using testing::kPeriod;

struct Session {
  scene::Scene scene = testing::ball_scene(1);
  bus::MemoryBus bus;
  bus::Reader<SurfaceTopology> surfaces = bus.reader(bus::kSurface);
  bus::Reader<NodePositions> nodes = bus.reader(bus::kNodePositions);
  bus::Reader<ContactModel> models = bus.reader(bus::kContactModel);
  SurfaceTopology surface;
  NodePositions positions;
  ContactModel model;
  DeformationStage stage{scene, {geometry::make_ball(testing::kBallRadius, 1)}, bus};

  runtime::Health cycle(bool running, bool reset = false) {
    runtime::Cycle now;
    now.running = running;
    now.reset = reset;
    now.advance = kPeriod;
    return stage.cycle(now);
  }
};

/// A plate that comes down on the ball and stays, with whoever speaks for it.
struct Pressing : Session {
  bus::Writer<ProbeState> states = bus.writer(bus::kProbeState);
  bus::Writer<Contacts> contacts = bus.writer(bus::kContacts);
  std::int64_t now_ns = 1'000'000'000;
  double height = testing::kBallRadius;
  bool goes_on = false;
  runtime::Health health;

  void cycle(bool told) {
    now_ns += ns_from_seconds(kPeriod);
    height = std::max(height - 2e-4, testing::kBallRadius - 4e-3);
    if (told) tell();
    runtime::Cycle now;
    now.running = true;
    now.goes_on = std::exchange(goes_on, false);
    now.advance = kPeriod;
    now.now_ns = now.sim_time_ns = now_ns;
    health = stage.cycle(now);
  }
  void tell() {
    ProbeState state;
    state.header.source_time_ns = now_ns;
    state.pose = Pose{Vec3(0, 0, height), Quat::Identity()};
    states.write(state);
    Contacts found;
    static_cast<ContactSet&>(found) = testing::plate_contacts(stage.world(), 0, height, 1, 2e-3);
    found.generations = {1};
    found.header.source_time_ns = now_ns;
    contacts.write(found);
  }
};

/// Of each block of triangles, by brute force over their corners.
std::vector<float> boxes_of(const SurfaceTopology& surface, const NodePositions& positions) {
  std::vector<geometry::BlockBox> boxes;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const std::uint32_t block = surface.triangle_blocks.at(t);
    boxes.resize(std::max<std::size_t>(boxes.size(), block + 1));
    for (const std::uint32_t node : surface.triangles[t]) {
      const float* x = positions.positions.data() + 3 * node;
      boxes[block].add(Vec3(x[0], x[1], x[2]));
    }
  }
  std::vector<float> floats;
  for (const geometry::BlockBox& box : boxes) {
    floats.insert(floats.end(), box.lower.begin(), box.lower.end());
    floats.insert(floats.end(), box.upper.begin(), box.upper.end());
  }
  return floats;
}

}  // namespace

TEST_CASE("deformation stage: says its organs' surfaces when built, and again after a reset") {
  // Oracle: the generation counts.
  Session session;
  REQUIRE(session.surfaces.take(session.surface));
  CHECK(session.surface.generation == 1);
  CHECK(session.surface.name == session.scene.organs[0].name);
  CHECK_FALSE(session.surfaces.take(session.surface));
  session.cycle(true, /*reset=*/true);
  REQUIRE(session.surfaces.take(session.surface));
  CHECK(session.surface.generation == 2);
}

TEST_CASE(
    "deformation stage: advances by what the cycle may take on, and only while the session "
    "runs, and speaks of the organs both times") {
  // Oracle: the world's own time.
  Session session;
  session.cycle(false);
  CHECK(session.stage.world().time() == 0);
  CHECK(session.nodes.take(session.positions));
  const auto health = session.cycle(true);
  CHECK(session.stage.world().time() == kPeriod);
  CHECK(session.nodes.take(session.positions));
  CHECK(session.positions.header.sim_time_ns == 4'000'000);
  CHECK(health.least_advance > 0);
  CHECK(health.least_advance <= kPeriod);
}

TEST_CASE(
    "deformation stage: where its session's time begins anew, so does what it has simulated") {
  // Oracle: cycles of a period each; a launcher that is killed and comes back counts from 0.
  Session session;
  double since = 0, factor = 0;
  const auto cycle_at = [&](double time) {
    runtime::Cycle now;
    now.running = true;
    now.advance = kPeriod;
    now.sim_time_ns = ns_from_seconds(time);
    factor = session.stage.cycle(now).real_time_factor;
    REQUIRE(session.nodes.take(session.positions));
    since = seconds_from_ns(session.positions.header.sim_time_ns);
  };
  for (int k = 0; k < 250; ++k) cycle_at(7 + k * kPeriod);
  CHECK(since == Approx(7 + 250 * kPeriod));
  CHECK(factor == Approx(1));
  for (int k = 0; k < 10; ++k) cycle_at(k * kPeriod);
  CHECK(since == Approx(10 * kPeriod));
  CHECK(factor == Approx(1));
  CHECK(session.stage.world().time() == Approx(260 * kPeriod));
}

TEST_CASE(
    "deformation stage: tells the box of every block of triangles, of the positions it tells") {
  // Oracle: brute force over the corners of each block's triangles.
  Session session;
  REQUIRE(session.surfaces.take(session.surface));
  REQUIRE(session.surface.triangle_blocks.size() == session.surface.triangles.size());
  for (int cycle = 0; cycle < 3; ++cycle) {
    session.cycle(true);
    REQUIRE(session.nodes.take(session.positions));
    CHECK(session.positions.block_boxes == boxes_of(session.surface, session.positions));
  }
}

TEST_CASE(
    "deformation stage: boxes are of the mesh they come with, if it changes in every advance") {
  // Oracle: brute force, as above, over the surface told under the generation of the positions. A
  // reset, with the probe away, comes between the two advances of a change.
  scene::Scene scene = testing::ball_scene(0);
  scene.organs[0].model = "nodal_pressure";
  scene.organs[0].solid.refine.follow = true;
  scene.organs[0].solid.refine.nodes = 2000;
  scene.rates.deformation = 100;
  scene.probes.push_back({"tip", scene::SphereShape{8e-3}, 0.0, scene::ScriptedDevice{}});
  bus::MemoryBus bus;
  bus::Reader<SurfaceTopology> surfaces = bus.reader(bus::kSurface);
  bus::Reader<NodePositions> nodes = bus.reader(bus::kNodePositions);
  auto probe = bus.writer(bus::kProbeState);
  const Vec3 size(0.1, 0.1, 0.05);
  DeformationStage stage(scene, {geometry::shape_of(geometry::testing::block(size, 5, 5, 3))}, bus);
  std::vector<SurfaceTopology> told;
  const auto take_told = [&] {
    SurfaceTopology surface;
    while (surfaces.take(surface)) told.push_back(surface);
  };
  take_told();
  std::size_t changes = 0, in_a_row = 0, most_in_a_row = 0;
  std::uint32_t generation = 1;
  for (int cycle = 1; cycle < 60; ++cycle) {
    ProbeState state;
    const bool reset = cycle % 20 == 19;
    state.pose.position = Vec3(0.05 + 0.03 * std::sin(0.4 * cycle), 0.05, reset ? 0.5 : 0.055);
    state.header.source_time_ns = 10'000'000 * cycle;
    REQUIRE(probe.write(state));
    runtime::Cycle now;
    now.running = true;
    now.advance = 0.01;
    now.now_ns = 10'000'000 * cycle;
    now.reset = reset;
    stage.cycle(now);
    take_told();
    NodePositions positions;
    REQUIRE(nodes.take(positions));
    const auto of_it = std::ranges::find(told, positions.generation, &SurfaceTopology::generation);
    REQUIRE(of_it != told.end());
    CHECK(positions.block_boxes == boxes_of(*of_it, positions));
    const bool changed = std::exchange(generation, positions.generation) != positions.generation;
    changes += changed;
    in_a_row = changed ? in_a_row + 1 : 0;
    most_in_a_row = std::max(most_in_a_row, in_a_row);
  }
  CHECK(changes > 20);
  CHECK(most_in_a_row > 2);  // else each change had a cycle for itself
}

TEST_CASE("deformation stage: a law is given by a cycle that advances, not by one that waits") {
  // Oracle: the stated rule, by counting.
  Session session;
  session.cycle(false);
  CHECK_FALSE(session.models.take(session.model));
  session.cycle(true);
  CHECK(session.models.take(session.model));
  for (int i = 0; i < 10; ++i) session.cycle(false);
  CHECK_FALSE(session.models.take(session.model));
  CHECK(session.nodes.take(session.positions));
  session.cycle(true);
  CHECK(session.models.take(session.model));
}

TEST_CASE("deformation stage: what organs have been is what it said of them since it first ran") {
  // Oracle: the messages.
  Session session;
  session.stage.ask_for_volume(0, 0.8);
  CHECK(session.cycle(false).organs[0].worst_volume_error == 0);
  double worst = 0, lowest = 0, highest = 0;
  for (int i = 0; i < 20; ++i) {
    const runtime::Health health = session.cycle(i < 15);
    REQUIRE(session.nodes.take(session.positions));
    const double ratio = session.positions.volume / session.positions.target_volume;
    worst = std::max(worst, std::abs(ratio - 1));
    lowest = std::min(lowest, session.positions.pressure);
    highest = std::max(highest, session.positions.pressure);
    REQUIRE(health.organs.size() == 1);
    CHECK(health.organs[0].organ == 0);
    CHECK(health.organs[0].volume_ratio == ratio);
    CHECK(health.organs[0].worst_volume_error == worst);
    CHECK(health.organs[0].lowest_pressure == lowest);
    CHECK(health.organs[0].highest_pressure == highest);
  }
  CHECK(worst > 0);
  CHECK(highest - lowest > 0);
}

TEST_CASE("deformation stage: probes that nobody speaks for touch nothing, and it says so") {
  // Oracle: the documented limit; the clock stands a second after the last word.
  Session session;
  runtime::Cycle now;
  now.running = true;
  now.advance = kPeriod;
  now.now_ns = 1'000'000'000;
  CHECK(std::string(session.stage.cycle(now).guard) ==
        "a probe or its contacts are stale: the hand feels nothing of it");
}

TEST_CASE("deformation stage: a law is as old as its contacts once they have stopped coming") {
  // Oracle: the stated rule, on a clock by hand. Whoever feels such a law lets go by his own clock,
  // stale_after_s + fade_time_s after at most UsualAge::kLeast, if there is never another cycle.
  Session session;
  auto states = session.bus.writer(bus::kProbeState);
  auto contacts = session.bus.writer(bus::kContacts);
  constexpr std::int64_t kCycleNs = 4'000'000, kLastHeardNs = 20 * kCycleNs;
  double height = testing::kBallRadius;
  bool had_rows = false;
  std::int64_t last_with_rows_ns = 0;
  for (std::int64_t now_ns = kCycleNs; now_ns <= 40 * kCycleNs; now_ns += kCycleNs) {
    ProbeState state;
    state.header.source_time_ns = now_ns;
    state.pose = Pose{Vec3(0, 0, height), Quat::Identity()};
    states.write(state);
    if (now_ns <= kLastHeardNs) {
      height -= 2e-4;
      state.pose.position.z() = height;
      Contacts found;
      static_cast<ContactSet&>(found) =
          testing::plate_contacts(session.stage.world(), 0, height, 1, 2e-3);
      found.generations = {1};
      found.header.source_time_ns = now_ns;
      contacts.write(found);
    }
    runtime::Cycle now;
    now.running = true;
    now.advance = kPeriod;
    now.now_ns = now_ns;
    session.stage.cycle(now);
    REQUIRE(session.models.take(session.model));
    const std::int64_t law_ns = session.model.header.source_time_ns;
    const bool stopped = 1e-9 * double(now_ns - kLastHeardNs) > UsualAge::kLeast;
    if (!session.model.rows.empty()) {
      had_rows = true;
      last_with_rows_ns = law_ns;
      CHECK(law_ns == (stopped ? kLastHeardNs : now_ns));
      CHECK(session.model.anchor_age >= 0);
    } else {
      CHECK(law_ns == now_ns);
    }
  }
  CHECK(had_rows);
  CHECK(session.model.rows.empty());
  CHECK(last_with_rows_ns == kLastHeardNs);
}

TEST_CASE(
    "deformation stage: one that goes on stands still until it hears what touches its organs") {
  // Oracle: the nodes' bits, and who goes on with the very same; on a clock by hand.
  for (const bool heard : {true, false}) {
    Pressing first;
    for (int k = 0; k < 50; ++k) first.cycle(true);
    StateArchive kept;
    first.stage.exchange(kept);
    Pressing second;
    second.now_ns = first.now_ns + 500'000'000;
    second.height = first.height;
    StateArchive given(kept.bytes());
    second.stage.exchange(given);
    const auto nodes = [](const Pressing& session) {
      const auto span = session.stage.world().positions(0);
      return std::vector<Vec3>(span.begin(), span.end());
    };
    const std::vector<Vec3> before = nodes(first);
    second.goes_on = true;
    for (int k = 0; k < 100; ++k) second.cycle(false);
    CHECK(nodes(second) == before);
    CHECK(std::string(second.health.guard) ==
          "what touches its organs is not heard of yet: they stand still");
    CHECK_FALSE(second.models.take(second.model));  // nor a law
    if (heard) {
      second.cycle(true);
      CHECK(std::string(second.health.guard).empty());
      CHECK(nodes(second) != before);
      CHECK((nodes(second)[0] - before[0]).norm() < 1e-4);
      CHECK(second.stage.world().force(0).z() > 0.5 * first.stage.world().force(0).z());
      CHECK(second.health.real_time_factor == Approx(1));  // of its own time
    } else {
      for (int k = 0; k < 200; ++k) second.cycle(false);
      CHECK(nodes(second) != before);  // nobody comes: the ball comes back
      CHECK(second.stage.world().force(0).norm() == 0);
    }
  }
}
