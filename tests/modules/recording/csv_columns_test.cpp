#include "modules/recording/csv_columns.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <sstream>

namespace palpate::recording {
namespace {

std::string number(double value) {
  std::ostringstream stream;
  write_number(stream, value);
  return stream.str();
}

std::string values_of(const AnyMessage& message) {
  std::ostringstream stream;
  write_csv_values(stream, message);
  return stream.str();
}

long columns_in(const std::string& row) { return 1 + std::count(row.begin(), row.end(), ','); }

}  // namespace

TEST_CASE("csv columns: numbers are as short as they can be and read back the same") {
  // Oracle: round trip through the C library; texts by hand.
  CHECK(number(0.1) == "0.1");
  CHECK(number(-2) == "-2");
  CHECK(number(std::numeric_limits<double>::infinity()) == "inf");
  CHECK(number(std::numeric_limits<double>::quiet_NaN()) == "nan");
  for (const double value : {1.0 / 3, 1e-300, 6.02214076e23, -7.0 / 11}) {
    CHECK(std::stod(number(value)) == value);
  }
}

TEST_CASE("csv columns: times keep their nanoseconds") {
  // Oracle: decimal shifts by hand; ten days and one nanosecond.
  const auto seconds = [](std::int64_t ns) {
    std::ostringstream stream;
    write_seconds(stream, ns);
    return stream.str();
  };
  CHECK(seconds(44'250'000) == "0.04425");
  CHECK(seconds(-1) == "-1e-09");
  CHECK(seconds(864'000'000'000'001) == "864000.000000001");
}

TEST_CASE("csv columns: texts are quoted where they need to be") {
  // Oracle: RFC 4180.
  CHECK(csv_text("plain") == "plain");
  CHECK(csv_text("a,b") == "\"a,b\"");
  CHECK(csv_text("say \"ah\"") == "\"say \"\"ah\"\"\"");
  CHECK(csv_text("two\nlines") == "\"two\nlines\"");
}

TEST_CASE("csv columns: every kind of message has as many values as columns") {
  // Oracle: invariant of a table.
  const AnyMessage messages[] = {ProbeState{},    Contacts{},         ContactModel{},
                                 NodePositions{}, SurfaceTopology{},  HapticForce{},
                                 ModuleStatus{},  SceneDescription{}, SessionControl{}};
  for (const AnyMessage& message : messages) {
    CAPTURE(csv_columns(message));
    CHECK(columns_in(csv_columns(message)) == columns_in(values_of(message)));
  }
}

TEST_CASE("csv columns: values stand under their names") {
  // Oracle: rows written by hand.
  NodePositions nodes;
  nodes.generation = 2;
  nodes.positions.resize(9);
  nodes.volume = 0.5;
  nodes.target_volume = 0.25;
  nodes.pressure = -3;
  nodes.kinetic_energy = 4;
  nodes.elastic_energy = 5;
  CHECK(values_of(nodes) == "2,3,0.5,0.25,-3,4,5");

  HapticForce force;
  force.force = {1, 2, 3};
  force.torque = {4, 5, 6};
  force.limits = 9;
  force.passivity_energy = -7;
  force.contact_model_age = 0.125;
  CHECK(values_of(force) == "1,2,3,4,5,6,9,-7,0.125");

  Contacts contacts;
  contacts.contacts.resize(2);
  contacts.contacts[1].gap = -0.5;
  contacts.node_positions_sequence = 8;
  CHECK(values_of(contacts) == "2,-0.5,0,8");

  ModuleStatus status;
  status.state = ModuleState::kDegraded;
  status.rate_hz = 250;
  status.last_error = "late, very";
  CHECK(values_of(status) == "degraded,250,0,0,0,0,0,0,0,\"late, very\"");

  SessionControl control;
  control.command = SessionCommand::kStop;
  CHECK(values_of(control) == "stop,0,0");
}

TEST_CASE("csv columns: keys are those of the wire types") {
  // Oracle: the @key fields in idl/.
  ProbeState probe;
  probe.probe = 3;
  SurfaceTopology surface;
  surface.organ = 1;
  ModuleStatus status;
  status.module = "haptics";
  CHECK(key_of(probe) == "3");
  CHECK(key_of(surface) == "1");
  CHECK(key_of(status) == "haptics");
  CHECK(key_of(SceneDescription{}).empty());
}

TEST_CASE("csv columns: every state of a module has a name") {
  // Oracle: idl/ModuleStatus.idl.
  CHECK(name_of(ModuleState::kStarting) == std::string("starting"));
  CHECK(name_of(ModuleState::kStopped) == std::string("stopped"));
  CHECK(name_of(static_cast<ModuleState>(7)) == std::string("unknown"));
}

}  // namespace palpate::recording
