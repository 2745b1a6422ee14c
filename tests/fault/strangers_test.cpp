// Programs that meet a session by accident: they speak its protocol, under its name, and are not of
// it.
#include "tests/system/running_session.h"

#include <catch2/catch.hpp>

using namespace palpate;
using namespace palpate::testing;

namespace {

/// A launcher and its processes under the same name, as of another user or on another host.
class SecondSession {
 public:
  explicit SecondSession(const bus::BusOptions& options) : bus_(with_another_token(options)) {}

  /// Stops, resets, another scene, and what would throw the probe and the organ about.
  void speak() {
    SessionControl stop;
    stop.command = SessionCommand::kStop;
    controls_.write(stop);
    SceneDescription scene;
    scene.name = scene.digest = "another";
    scenes_.write(scene);
    ProbeState far;
    far.pose.position = Vec3(0.3, 0.3, 0.3);
    inputs_.write(far);
    states_.write(far);
    NodePositions nodes;
    nodes.positions.assign(3, 0.f);
    nodes_.write(nodes);
    ContactModel nothing;
    models_.write(nothing);
    Contacts none;
    contacts_.write(none);
  }
  bool heard_by_all() const {
    return controls_.matched_readers() >= 4 && inputs_.matched_readers() >= 1 &&
           models_.matched_readers() >= 2;
  }

 private:
  static bus::BusOptions with_another_token(bus::BusOptions options) {
    options.token = 1;
    return options;
  }

  bus::DdsBus bus_;
  bus::Writer<SessionControl> controls_ = bus_.writer(bus::kSessionControl);
  bus::Writer<SceneDescription> scenes_ = bus_.writer(bus::kScene);
  bus::Writer<ProbeState> inputs_ = bus_.writer(bus::kProbeInput);
  bus::Writer<ProbeState> states_ = bus_.writer(bus::kProbeState);
  bus::Writer<NodePositions> nodes_ = bus_.writer(bus::kNodePositions);
  bus::Writer<ContactModel> models_ = bus_.writer(bus::kContactModel);
  bus::Writer<Contacts> contacts_ = bus_.writer(bus::kContacts);
};

}  // namespace

TEST_CASE("strangers: a second session under the same name neither conducts nor moves the first") {
  // Oracle: the pressed force stays that of the same pose, nobody ends or refuses to play, and each
  // process says that it refused some. Without tokens the first word of it ends all processes.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  const double force = session.rest_pressed(0.05);
  REQUIRE(force > 0);
  SecondSession second(session.options());
  REQUIRE(session.wait([&](const Heard&) { return second.heard_by_all(); }));
  const std::uint64_t then = session.heard().force.header.sequence;
  session.forget_largest();
  CHECK(session.wait([&](const Heard& heard) {
    second.speak();
    return heard.force.header.sequence > then + 2000;
  }));
  CHECK(session.all_go_on_refusing(100));
  for (const auto& [name, module] : session.heard().modules) {
    INFO(name);
    for (const auto& input : module.inputs) CHECK(input.rejected == 0);
  }
  CHECK(session.heard().force.force.norm() == Approx(force).epsilon(0.1));
  CHECK(session.heard().largest_force < 1.1 * force);
}
